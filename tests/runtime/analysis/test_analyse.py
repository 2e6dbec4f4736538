"""What `ltcgear analyse` tells of simulations, and its figures."""

import csv
import json
import re

import numpy as np
import pytest
from ltcgear.runtime.analysis import (
    analyse,
    find_density,
    find_load_share,
    find_orbit,
    find_order_spectrum,
    find_transmission_error,
    find_waterfall,
    mesh_courses,
    name_lines,
    select_output,
    shaft_angle,
)
from ltcgear.runtime.analysis.lines import Clues
from ltcgear.runtime.analysis.survey import Options
from ltcgear.runtime.api import restoring
from ltcgear.runtime.api.restoring import find_background, restore_modes
from ltcgear.runtime.simulation.simulate import simulate
from ltcgear.runtime.view import draw_bearings, draw_spectrum, draw_survey, list_tables
from ltcgear.runtime.view.figures.drawing import pool, scale_of, thin
from ltcgear.runtime.view.plots import save_figure

from ..model.test_load_sharing import shares
from ..models import case
from ..outputs import band_limited
from ..synthetic import make_dataset

KINDS = {
    "forces", "shares", "spectrum", "density", "orders", "spectrogram", "waterfall", "envelope", "transmission", "load",
    "rainflow", "bearings", "orbits",
}  # fmt: skip


def simulated(name, *settings, t_end, rate=8192.0, **attributes):
    found = case(name, *settings)
    about = {"scene": name, "scene_json": found.scene.model_dump_json()} | attributes
    return simulate(
        found.library, found.model.values(), t_end=t_end, rate=rate, tables=found.model.tables, attributes=about
    )


@pytest.fixture(scope="module")
def rig():
    return simulated("rig-2mw", t_end=2.0)


@pytest.fixture(scope="module")
def limited():
    """The rig's mesh forces and accelerations without aliases."""
    return band_limited(simulated("rig-2mw", t_end=2.0, rate=4 * 8192.0).dataset, 4)


@pytest.fixture(scope="module")
def file(rig, tmp_path_factory):
    path = tmp_path_factory.mktemp("analyse") / "rig.nc"
    rig.save(path)
    return path


@pytest.fixture(scope="module")
def survey(rig):
    return analyse(rig.dataset)


# --- the product


def test_the_lines_of_the_rig_are_named(survey):
    meshes = {"lsp": 29.5, "hsp": 158.227, "psh": 628.255}
    assert survey.clues.meshes == pytest.approx(meshes, rel=1e-5)
    strongest = {seen.output: seen.lines[0].name for seen in survey.seen}
    assert strongest["mesh_force:hsp.sun_planet.1"] == "1 hsp"
    assert strongest["mesh_force:lsp.ring_planet.1"] == "1 lsp"
    named = [line for seen in survey.seen for line in seen.lines]
    for line in named:
        harmonic = re.fullmatch(r"(\d+) (\w+)", line.name)
        if harmonic:
            assert line.place == pytest.approx(int(harmonic[1]) * meshes[harmonic[2]], abs=0.6)


@pytest.mark.parametrize("span", [(None, None), (0.9, 1.9)])
def test_under_steady_loads_every_line_is_forced(rig, limited, span):
    """Torques are constant and vibrations of the start are gone: only meshes force, and no line is a free mode.

    In frames that turn with the carrier there are sidebands at its turns, a suns' acceleration has little else.
    """
    modes = restore_modes(rig.dataset.attrs["scene_json"]).modes
    found = analyse(limited, Options(*span), modes)
    lines = [line for seen in found.seen for line in (*seen.lines, *seen.order_lines)]
    assert {line.kind for line in lines} <= {"harmonic", "sideband"}
    assert sum(bool(line.mode) for line in lines) > 10
    assert not [line for line in lines if line.place > 0.4 * 8192.0]
    sun = analyse(limited, Options(*span, outputs=("acceleration:hsp.sun",)), modes).seen[0].lines
    assert {(line.kind, line.name.partition(" hsp ")[2]) for line in sun} >= {("sideband", "- 1 hsp.carrier")}
    assert all(line.kind in ("harmonic", "sideband") for line in sun)
    assert any(line.name == "46 lsp" for line in lines)


def test_meshes_are_ranked_by_their_damage(survey):
    """Equivalent ranges to the power of the slope times the tooth meshes are the sums of n r^6 of the counts."""
    table = list_tables(survey)["rainflow"]
    assert table.columns[-2:] == ("tooth meshes", "equivalent kN")
    rows = {row[0]: row for row in table.rows}
    damages = {one.name.partition(":")[2]: float((one.count * one.span**6).sum()) for one in survey.cycles}
    for mesh, row in rows.items():
        assert (1e3 * row[-1]) ** 6 * row[-2] == pytest.approx(damages[mesh], rel=1e-9)
    assert rows["hsp.sun_planet.1"][-1] > rows["hsp.ring_planet.1"][-1]


def test_planets_stay_on_their_pins(rig, survey):
    """The wound-up train turns the carrier by degrees; planets are off their places by what pins yield."""
    assert np.abs(survey.span["displacement_x"].sel(member="hsp.planet.2")).max() > 0.02
    for planet in ("hsp.planet.1", "hsp.planet.2", "lsp.planet.3"):
        assert np.hypot(*find_orbit(survey.span, planet, rig.dataset).centre) < 5e-4
    held = {row[0]: row[1] for row in list_tables(survey)["orbits"].rows}
    assert (held["hsp.carrier"], held["lsp.sun"], held["hsp.sun"]) == ("no bearing", "no bearing", "bearing")


def test_one_rule_says_which_modes_name_lines(data, rig, file, monkeypatch):
    """A report and an analysis name lines by the same modes, those that `ltcgear modes` lists."""
    monkeypatch.setattr(restoring, "MANY", 4)
    monkeypatch.setattr(restoring, "FEW", 17)
    modes = find_background(rig, True).modes
    assert len(modes) == 17
    near = {row[5] for row in data("analyse", file)["tables"]["lines-mesh_force"]["rows"]} - {None}
    assert near
    assert {int(name.split()[1]) for name in near} <= set(range(1, 18))


def test_over_the_output_shaft_the_pair_is_its_teeth(survey):
    over = {seen.output: seen for seen in survey.seen}["mesh_force:psh.mesh"]
    assert over.orders.shaft == "psh.output"
    orders = {round(line.place, 2) for line in over.order_lines if line.name.endswith(" psh")}
    assert orders <= {21.0, 42.0, 63.0, 84.0, 105.0}
    assert "4 psh" in {line.name for line in over.order_lines}


def test_forces_are_those_of_the_summary(rig, survey):
    assert survey.forces == rig.summary["forces"]


def test_the_load_of_a_turn_is_counted(survey):
    counted = {one.name: one.count.sum() for one in survey.durations}
    assert counted["mesh_force:psh.mesh"] == pytest.approx(628.255, rel=1e-3)
    assert counted["mesh_force:lsp.sun_planet.1"] == pytest.approx(29.5, rel=1e-3)


@pytest.mark.parametrize("scene", ["floating-on", "floating-off"])
def test_a_misplaced_pin_shows_in_the_shares_as_statics_has_it(scene):
    """With mean stiffness nothing vibrates, so shares over time are those of the equilibrium."""
    setting = "effects.mesh_stiffness = 'mean'"
    found = find_load_share(simulated(scene, setting, t_end=0.05).dataset, "lsp.sun_planet")
    assert found.mean == pytest.approx(shares(scene, setting), abs=1e-6)
    assert found.mean == pytest.approx(shares(scene), abs=5e-3)
    assert found.mesh_load_factor > 1.03


def test_an_eccentric_gear_against_its_closed_form():
    """Turning slowly, gear 2 runs ahead and behind by e sin(theta_1 + ...), whatever the stiffnesses."""
    settings = (
        "effects.eccentricity = 'on'", "effects.mesh_stiffness = 'mean'", "loads.input.speed = '-60 rpm'",
        "stages.psh.input.eccentricity = {radius = '50 um'}",
    )  # fmt: skip
    found = simulated("psh", *settings, t_end=4.0, rate=512.0)
    error = find_transmission_error(found.dataset.sel(time=slice(1.0, 4.0)), "psh.mesh", "angles")
    assert error.peak_to_peak == pytest.approx(100e-6, rel=5e-3)
    spectrum = np.abs(np.fft.rfft(error.value[:1536])) * 2 / 1536
    assert spectrum[3] == pytest.approx(50e-6, rel=2e-3)  # 1 Hz in 3 s
    assert np.delete(spectrum, [0, 3]).max() < 1e-6
    by_deflection = find_transmission_error(found.dataset, "psh.mesh")
    assert by_deflection.peak_to_peak < 2e-6


def test_a_start_up_gives_straight_lines():
    """Teeth of the output in a turn: 21. Its line climbs with the speed, and is one order.

    Stiffness follows the rigid motion; over the shaft's own angle, which swings, the second harmonic is off by a bin.
    """
    found = simulated("start-up", t_end=1.2)
    dataset = found.dataset.sel(time=slice(0.3, 1.05))
    (deflection,) = select_output(dataset, "mesh_deflection:pair.mesh.back")
    over = find_order_spectrum(deflection, shaft_angle(dataset, "pair.output"))
    lines = name_lines(over, Clues({"pair": 21.0}), 4)
    assert [line.place for line in lines if line.name == "1 pair"] == pytest.approx([21.0], abs=0.5 * over.resolution)
    assert min(abs(line.place - 42.0) for line in lines) < 1.5 * over.resolution
    rigid = (dataset["reference_angle"] * dataset["speed_ratio"]).sel(rotor="pair.output").assign_attrs(units="rad")
    places = {
        line.name: line.place for line in name_lines(find_order_spectrum(deflection, rigid), Clues({"pair": 21.0}))
    }
    assert {name: places[name] for name in ("1 pair", "2 pair", "4 pair")} == pytest.approx(
        {"1 pair": 21.0, "2 pair": 42.0, "4 pair": 84.0}, abs=0.5 * over.resolution
    )
    (speed,) = select_output(dataset, "speed:pair.output")
    fall = find_waterfall(deflection, speed, resolution_hz=16.0)
    course = mesh_courses(dataset, fall)["pair"]
    assert course == pytest.approx(21.0 * fall.speed / 60.0, rel=0.01)
    beside = fall.frequency[None, :] - course[:, None]
    near = np.where((np.abs(beside) < 0.4 * course[:, None]) & (fall.frequency > 80.0), fall.amplitude, 0.0)
    ridge = fall.frequency[np.argmax(near, axis=1)]
    assert np.abs(ridge - course)[course > 150.0].max() <= 16.0


# --- figures


def check_axes(figure):
    titled = bool(figure.get_suptitle())
    for axes in figure.axes:
        if not axes.axison:
            continue
        bar = axes.get_label() == "<colorbar>"
        labels = [axes.get_ylabel() or axes.get_xlabel()] if bar else [axes.get_xlabel(), axes.get_ylabel()]
        for label in labels:
            assert re.search(r"\[.+\]$", label) or label == "bearing or pin", label
        assert bar or titled or axes.get_title(loc="left")
        drawn = [line for line in axes.get_lines() if len(line.get_xdata())]
        if len(drawn) + len(axes.containers) > 1:
            legend = axes.get_legend() or (figure.legends and figure.legends[0])
            assert legend
            assert legend.get_texts()


def test_every_figure_has_units_title_and_legend_and_stays_small(survey, tmp_path):
    seen = set()
    for name, figure in draw_survey(survey):
        seen.add(name.partition("-")[0])
        check_axes(figure)
        path = save_figure(figure, tmp_path / f"{name}.svg")
        assert path.read_text("utf-8").startswith("<?xml")
        assert path.stat().st_size < 200_000, name
    assert seen == KINDS


def test_a_density_says_how_it_was_taken(survey):
    density = find_density(select_output(survey.span, "mesh_force:psh.mesh")[0])
    axes = draw_spectrum(density).axes[0]
    assert axes.get_ylabel() == "density [N²/Hz]"
    (text,) = (text.get_text() for text in axes.get_legend().get_texts())
    assert "hann window, 1 to 2 s" in text
    assert "bins 8 Hz apart" in text
    assert "noise bandwidth 12 Hz" in text
    assert "15 segments averaged" in text


def test_equal_figures_give_equal_files(survey, tmp_path):
    one, two = (save_figure(draw_bearings(survey.bearings), tmp_path / f"{k}.svg") for k in "ab")
    assert one.read_bytes() == two.read_bytes()


def test_thinning_keeps_every_peak():
    x = np.arange(10_000.0)
    y = np.sin(x)
    y[[1234, 7777]] = 5.0, -5.0
    thin_x, thin_y = thin(x, y, 100)
    assert thin_x.size == 200
    assert (np.diff(thin_x) > 0).all()
    assert {(1234.0, 5.0), (7777.0, -5.0)} <= set(zip(thin_x.tolist(), thin_y.tolist(), strict=True))
    assert thin(x[:50], y[:50])[0].size == 50
    assert pool(y, 100).max() == 5.0
    assert pool(y, 100).shape == (100,)


@pytest.mark.parametrize(
    ("unit", "largest", "shown"),
    [("N", 999.0, (1.0, "N")), ("N", 1e6, (1e3, "kN")), ("m", 1e-9, (1e-6, "µm")), ("m", 2e-3, (1e-3, "mm")),
     ("m/s^2", 1e5, (1.0, "m/s²"))],
)  # fmt: skip
def test_units_are_handy(unit, largest, shown):
    assert scale_of(unit, largest) == shown


# --- the command


def test_tables_of_a_result(data, file):
    shown = data("analyse", file, "--lines", "6")
    assert (shown["scene"], shown["from_s"], shown["to_s"], shown["files"]) == ("rig-2mw", 1.0, 2.0, [])
    tables = shown["tables"]
    lines = tables["lines-mesh_force"]
    assert lines["columns"] == ["output", "Hz", "amplitude N", "kind", "name", "mode near"]
    assert any(note.startswith("mode ") for note in lines["notes"])
    assert "noise bandwidth 1.5 Hz" in lines["notes"][0]
    assert {row[3] for row in lines["rows"]} <= {"harmonic", "sideband", "shaft", "mode", None}
    for name in ("forces", "shares", "transmission", "durations", "rainflow", "bearings", "orbits"):
        assert tables[name]["rows"], name


def test_figures_and_tables_are_written(run, file, tmp_path):
    folder = tmp_path / "out"
    options = ("--output", "acceleration:psh.output", "--from", "0.5", "--to", "1.5", "--no-modes", "--format", "svg")
    code, out, err = run("analyse", file, *options, "-o", folder)
    assert code == 0, err
    assert "Strongest lines of acceleration" in out
    assert (folder / "spectrum-acceleration-psh.output.svg").is_file()
    with (folder / "forces.csv").open(newline="") as opened:
        rows = list(csv.reader(opened))
    assert rows[0][:2] == ["mesh", "mean kN"]
    assert float(rows[1][1]) == pytest.approx(357.5, rel=1e-3)
    assert len(rows) == 16


def test_a_run_that_broke_down_is_told_and_analysed(data, rig, tmp_path):
    short = rig.dataset.isel(time=slice(0, 8000)).assign_attrs(status="stopped at 0.98 s: no more steps")
    short.to_netcdf(tmp_path / "short.nc")
    shown = data("analyse", tmp_path / "short.nc", "--no-modes")
    assert "did not reach its end (stopped at 0.98 s" in shown["notes"][0]
    assert shown["to_s"] == pytest.approx(7999 / 8192)


def test_without_a_scene_lines_are_named_by_meshes_only(data, rig, tmp_path):
    bare = rig.dataset.copy()
    del bare.attrs["scene_json"]
    bare.to_netcdf(tmp_path / "bare.nc")
    shown = data("analyse", tmp_path / "bare.nc")
    assert shown["notes"][0] == "the file holds no scene: lines are named by meshes and shafts only"
    assert {row[5] for row in shown["tables"]["lines-mesh_force"]["rows"]} == {None}


def test_without_rainflow_the_rest_is_told(data, file, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "rainflow", None)
    shown = data("analyse", file, "--no-modes")
    assert "rainflow" not in shown["tables"]
    assert any("pip install 'ltcgear[report]'" in note for note in shown["notes"])


def test_torsional_trains_have_no_orbits(data, tmp_path):
    simulated("psh", "effects.lateral = 'off'", t_end=0.2).save(tmp_path / "torsional.nc")
    tables = data("analyse", tmp_path / "torsional.nc", "--no-modes")["tables"]
    assert "orbits" not in tables
    assert "bearings" not in tables
    assert tables["forces"]["rows"]


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--from", "5"), "the record runs from 0 s to 2 s"),
        (("--from", "1", "--to", "1.001"), "samples, 64 at least"),
        (("--output", "mesh_force:psh.mech"), 'did you mean "psh.mesh"?'),
        (("--output", "mesh_force"), "write QUANTITY:ITEM, for example mesh_force:psh.mesh"),
        (("--shaft", "psh.outptu"), "did you mean 'psh.output'?"),
        (("--shaft", "lsp.ring"), "turns 0.25 times in the span, 4 at least"),
        (("--band", "300"), "write LOW:HIGH in Hz"),
        (("--band", "300:100"), "low before high"),
        (("--window", "hamming"), "must be one of hann"),
        (("--resolution", "0.1"), "must lie between"),
        (("--format", "jpg"), "must be one of png, svg, pdf"),
        (("-o", "/proc/nothing"), "cannot be made"),
    ],
)
def test_what_cannot_be_is_refused(refused, file, options, message):
    assert message in refused("analyse", file, "--no-modes", *options)


@pytest.mark.parametrize("quantity", ["displacement", "bearing_force", "pin_force", "acceleration"])
def test_files_that_lack_an_axis_are_refused(refused, rig, tmp_path, quantity):
    rig.dataset.isel(time=slice(0, 128)).drop_vars(f"{quantity}_y").to_netcdf(tmp_path / "half.nc")
    assert f"damaged: {quantity}_y missing" in refused("analyse", tmp_path / "half.nc", "--no-modes")


def test_files_that_are_no_results_are_refused(refused, tmp_path):
    assert "no such result file" in refused("analyse", tmp_path / "none.nc")
    (tmp_path / "text.nc").write_text("no")
    assert "not a readable NetCDF4 file" in refused("analyse", tmp_path / "text.nc")


def test_tables_are_json(survey):
    assert json.loads(json.dumps({name: table.to_json() for name, table in list_tables(survey).items()}))


def test_of_two_flanks_with_backlash_the_loaded_one_is_told():
    """The start-up loads the flank behind; both flanks share one phase."""
    found = analyse(simulated("start-up", t_end=0.5).dataset)
    assert [seen.output for seen in found.seen] == ["mesh_force:pair.mesh.back"]
    assert [error.mesh for error in found.errors] == ["pair.mesh.back", "pair.mesh"]
    assert [one.name for one in found.durations] == ["mesh_force:pair.mesh.back"]
    assert np.isfinite(found.errors[0].harmonics).all()


def test_a_dataset_of_few_quantities_is_analysed():
    found = analyse(make_dataset())
    assert {seen.lines[0].name for seen in found.seen} == {"1 lsp", "1 hsp", "1 psh"}
    assert {band.centre[0] for seen in found.seen for band in seen.sidebands} <= {"1 lsp", "1 hsp", "1 psh"}
    assert found.errors == ()
    assert found.orbits == ()


def test_a_train_at_rest_is_analysed():
    """Nothing turns and nothing vibrates: no lines, no shafts, no durations, and figures all the same."""
    run = simulated("lin-parker-3", t_end=0.1, rate=8192.0)
    assert np.abs(run.dataset["mesh_force"]).max() < 1.0  # what the tolerance leaves
    found = analyse(run.dataset)
    for forces in (found.forces, run.summary["forces"]):
        assert {value for one in forces.values() for key, value in one.items() if key != "load_factor"} == {0.0}
        assert all(np.isnan(one["load_factor"]) for one in forces.values())
    assert not [line for seen in found.seen for line in (*seen.lines, *seen.envelope_lines)]
    assert {one.rms for one in found.bearings} == {one.peak_to_peak for one in found.errors} == {0.0}
    assert found.shares == ()
    assert found.clues.meshes == found.clues.shafts == {}
    assert found.durations == ()
    assert not [note for note in found.notes if "smeared" in note]
    for _, figure in draw_survey(found):
        check_axes(figure)


def test_names_in_a_file_lead_to_no_other_folder(run, tmp_path):
    dataset = simulated("psh", t_end=0.2).dataset
    hostile = dataset.assign_coords(mesh=["../../psh.mesh"])
    hostile.to_netcdf(tmp_path / "hostile.nc")
    folder = tmp_path / "a" / "b" / "out"
    code, _, err = run("analyse", tmp_path / "hostile.nc", "--no-modes", "-o", folder)
    assert code == 0, err
    written = {path for path in tmp_path.rglob("*") if path.is_file()}
    assert {path.parent for path in written - {tmp_path / "hostile.nc"}} == {folder}


def test_angles_tell_what_teeth_and_bearings_yield():
    """Springs in series along the line of action: F / k of the teeth, and F / k of both bearings."""
    found = simulated("psh", "effects.mesh_stiffness = 'mean'", t_end=0.02)
    force, stiffness = 1.06e4 / found.parameters["psh.mesh.base_radius_2"], (7.06e9, 3.13e9)
    teeth, angles = (find_transmission_error(found.dataset, "psh.mesh", by).mean for by in ("deflection", "angles"))
    assert found.mesh["psh.mesh"].force.mean() == pytest.approx(force, rel=1e-6)
    assert angles - teeth == pytest.approx(sum(force / k for k in stiffness), rel=2e-3)
