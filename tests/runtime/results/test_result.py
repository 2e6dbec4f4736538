"""Results: named access, files, and files that are none."""

import copy
import json
import pickle
import shutil
from pathlib import Path

import netCDF4
import numpy as np
import pytest
import xarray as xr
from ltcgear.generated.errors import LtcgearError
from ltcgear.runtime import build, load, simulate
from ltcgear.runtime.results.checksums import SUMS
from ltcgear.runtime.results.file_schema import FORM
from ltcgear.runtime.results.table_export import export
from ltcgear.runtime.simulation.ensemble import simulate_many
from ltcgear.symbolic import build_model, describe_scene, load_scene, restore_scene
from ltcgear.symbolic.emit.pipeline import obtain
from scipy.io import loadmat


@pytest.fixture(scope="module")
def made():
    """The HSP's scene, model, library and a short run of it."""
    scene = load_scene("hsp")
    model = build_model(scene)
    library = build(obtain(model))
    options = {"t_end": 0.05, "rate": 8192.0, "tables": model.tables, "attributes": describe_scene(scene)}
    return scene, model, library, simulate(library, model.values(), **options)


@pytest.fixture(scope="module")
def file(made, tmp_path_factory):
    path = tmp_path_factory.mktemp("results") / "hsp.nc"
    made[3].save(path)
    return path


def test_quantities_are_reached_by_name(made):
    result = made[3]
    force = result.mesh["hsp.sun_planet.1"].force
    assert force.dims == ("time",)
    assert force.attrs == {"units": "N", "long_name": "normal mesh force"}
    assert np.array_equal(force, result.dataset["mesh_force"].sel(mesh="hsp.sun_planet.1"))
    assert result.pin["hsp.pin.2"].force_x.attrs["units"] == "N"
    assert set(result.rotor) == {str(name) for name in result.dataset["rotor"].values}
    assert {"force", "phase", "level", "deflection"} <= set(dir(result.mesh["hsp.sun_planet.1"]))


def test_names_that_are_not_there_are_told_with_what_is(made):
    result = made[3]
    with pytest.raises(KeyError, match=r"no mesh 'hsp.sunplanet.1'; did you mean 'hsp.sun_planet.1'"):
        result.mesh["hsp.sunplanet.1"]
    with pytest.raises(AttributeError, match=r"hsp.sun_planet.1 has no 'forces'; it has .*force"):
        result.mesh["hsp.sun_planet.1"].forces  # noqa: B018
    with pytest.raises(AttributeError, match=r"a result has no 'meshes'; it has .*mesh"):
        result.meshes  # noqa: B018


@pytest.mark.parametrize("name", ["hsp", "start-up", "hard-friction", "lin-parker-3"])
def test_angles_are_what_speeds_add_up_to(name):
    scene = load_scene(name)
    model = build_model(scene)
    result = simulate(build(obtain(model)), model.values(), t_end=0.2, rate=4096.0, tables=model.tables)
    time = result.dataset["time"].values
    for rotor, item in result.rotor.items():
        turned = item.angle.values - item.angle.values[0]
        added = np.concatenate([[0.0], np.cumsum((item.speed.values[1:] + item.speed.values[:-1]) / 2 * np.diff(time))])
        assert np.abs(turned - added).max() < 1e-3 * max(np.abs(added).max(), 1e-3), rotor


def test_steps_add_up_to_those_that_were_made(made):
    result = made[3]
    steps = result.dataset["steps"].values
    assert steps[0] == 0
    assert steps[-1] == pytest.approx(result.summary["counts"]["steps"], rel=1e-3)
    assert (np.diff(steps) > 0).all()


@pytest.mark.parametrize("method", ["cvodes", "rosenbrock"])
def test_steps_of_python_s_engines_add_up_too(made, method):
    _, model, library, _ = made
    result = simulate(library, model.values(), t_end=0.02, rate=8192.0, method=method)
    assert result.dataset["steps"].values[-1] == pytest.approx(result.summary["counts"]["steps"], rel=1e-2)
    assert (np.diff(result.dataset["steps"].values) > 0).all()


def test_a_file_keeps_data_summary_parameters_and_scene(made, file):
    scene, model, _, result = made
    found = load(file)
    assert found.dataset.equals(result.dataset)
    assert found.summary == {"scene": "hsp"} | result.summary
    assert found.parameters == model.values()
    assert restore_scene(found.dataset.attrs["scene_json"]) == scene


def test_plain_xarray_reads_a_file_with_units_and_statistics(file, made):
    with xr.open_dataset(file) as data:
        assert all("long_name" in v.attrs for v in data.data_vars.values())
        units = {str(name) for name, v in data.data_vars.items() if "units" not in v.attrs}
        assert units == {"parameter_value", "statistics"}  # each its own: parameter_unit, output_unit
        assert data["parameter_unit"].sel(parameter="hsp.sun.mass") == "kg"
        assert json.loads(data.attrs["statistics"])["hsp.sun_planet.1"] == made[3].summary["forces"]["hsp.sun_planet.1"]
        assert {"ltcgear", "casadi", "numpy"} <= set(json.loads(data.attrs["versions"]))


def test_the_command_line_s_file_tells_the_scene_as_written(run, tmp_path):
    written = Path("symbolic/scenes/psh.toml")
    scene = tmp_path / "mine.toml"
    shutil.copy(written, scene)
    target = tmp_path / "a.nc"
    code, _, err = run(
        "simulate", str(scene), "-o", str(target), "--t-end", "0.01", "--set", "loads.input.speed=-600 rpm"
    )
    assert code == 0, err
    kept = load(target).dataset.attrs
    assert kept["scene_text"] == written.read_text()
    assert json.loads(kept["changes"]) == {"loads.input.speed": "-600 rpm"}
    assert load(target).summary["simulated_s"] == pytest.approx(0.01, rel=0.01)


def test_sets_of_an_ensemble_keep_their_own_parameters(made):
    _, model, library, _ = made
    stiffer = model.values() | {"hsp.sun.mass": 80.0}
    one, two = simulate_many(library, [model.values(), stiffer], t_end=0.01, rate=4096.0)
    assert one.parameters == model.values()
    assert two.parameters == stiffer


# --- files that are none


def refusal(path: Path) -> str:
    with pytest.raises(LtcgearError) as caught:
        load(path)
    text = str(caught.value)
    assert text.startswith(f"{path}: ")
    assert "\n" not in text
    return text


def changed(file: Path, tmp_path: Path, change) -> Path:
    """A copy of a file after a change of its open NetCDF4."""
    copy = tmp_path / "changed.nc"
    shutil.copy(file, copy)
    with netCDF4.Dataset(copy, "a") as opened:
        change(opened)
    return copy


def test_a_missing_file_is_told(tmp_path):
    assert "no such result file; `ltcgear simulate SCENE -o" in refusal(tmp_path / "none.nc")


@pytest.mark.parametrize("part", [0.0, 0.001, 0.1, 0.5, 0.9, 0.999])
def test_a_truncated_file_is_refused(file, tmp_path, part):
    cut, data = tmp_path / "cut.nc", file.read_bytes()
    cut.write_bytes(data[: int(part * len(data))])
    assert "simulate again" in refusal(cut)


@pytest.mark.parametrize("seed", range(30))
def test_a_damaged_file_is_refused_or_read(file, tmp_path, seed):
    """Whatever bytes are turned over, there is a result or one message, never a traceback."""
    generator, data = np.random.default_rng(seed), bytearray(file.read_bytes())
    first = int(generator.integers(0, len(data) - 4096)) if seed % 2 else int(generator.integers(0, 20000))
    data[first : first + 512] = generator.bytes(512)
    damaged = tmp_path / "damaged.nc"
    damaged.write_bytes(bytes(data))
    wanted = load(file).dataset
    try:
        found = load(damaged).dataset
    except LtcgearError:
        return
    assert found.equals(wanted)  # what was overwritten was no data


def test_foreign_files_are_refused(tmp_path):
    foreign, text = tmp_path / "foreign.nc", tmp_path / "text.nc"
    xr.Dataset({"a": ("x", [1.0])}).to_netcdf(foreign)
    text.write_text("no NetCDF at all")
    assert "not a result of ltcgear" in refusal(foreign)
    assert "not a readable NetCDF4 file" in refusal(text)


@pytest.mark.parametrize(("form", "word"), [(None, "older"), (0, "older"), (99, "newer")])
def test_other_forms_are_refused(file, tmp_path, form, word):
    def change(opened):
        opened.delncattr("result_format")
        if form is not None:
            opened.setncattr("result_format", form)

    assert f"{word} than form {FORM}" in refusal(changed(file, tmp_path, change))


def test_forms_that_are_no_number_are_told(file, tmp_path):
    for form in ("1", [1, 1], 1.5):
        told = refusal(changed(file, tmp_path, lambda opened, form=form: opened.setncattr("result_format", form)))
        assert "damaged: attribute result_format is no whole number" in told


@pytest.mark.parametrize("name", ["counts", "method", "statistics", "warnings", "sheet"])
def test_attributes_that_are_missing_are_told(file, tmp_path, name):
    told = refusal(changed(file, tmp_path, lambda opened: opened.delncattr(name)))
    assert f"damaged: attribute {name} is missing" in told


@pytest.mark.parametrize(
    ("name", "value", "told"),
    [
        ("counts", "{", "is no JSON"),
        ("counts", '{"steps": "many"}', "does not hold what it should"),
        ("counts", '{"steps": true}', "does not hold what it should"),
        ("statistics", '{"a": {"mean": "x"}}', "does not hold what it should"),
        ("warnings", '{"a": "b"}', "does not hold what it should"),
        ("versions", "[]", "does not hold what it should"),
        ("changes", "[1", "is no JSON"),
        ("sheet", "3", "does not hold what it should"),
        ("sheet", '{"discs": [{"body": "a"}], "titles": [], "width": 1, "height": 1}', "does not hold what it should"),
        ("rtol", "abc", "is no number"),
        ("simulated_s", [1.0, 2.0], "is no number"),
        ("title", 3, "is no text"),
        ("accuracy", '{"meshes": {}, "worst": "a", "reason": null}', "does not hold what it should"),
        ("scene_json", "[" * 100_000, "is no JSON"),
        ("scene_json", '{"effects": [1], "sources": {}}', "does not hold what it should"),
    ],
)
def test_attributes_that_are_damaged_are_told(file, tmp_path, name, value, told):
    assert f"damaged: attribute {name} {told}" in refusal(
        changed(file, tmp_path, lambda opened: opened.setncattr(name, value))
    )


def test_attributes_that_were_changed_are_told(file, tmp_path):
    """What somebody adds is none of ltcgear's, and what Python writes anew has new sums."""
    for change, told in (
        (lambda opened: opened.setncattr("band_hz", 5.0), "attribute band_hz"),
        (lambda opened: opened.delncattr("title"), "attribute title"),
        (lambda opened: opened["mesh_force"].setncattr("units", "kN"), "attribute mesh_force:units"),
        (lambda opened: opened.setncattr(SUMS, "{}x"), f"attribute {SUMS}"),
    ):
        assert f"damaged: {told} is not what was written" in refusal(changed(file, tmp_path, change))
    result = load(changed(file, tmp_path, lambda opened: opened.setncattr("comment", "mine")))
    result.dataset.attrs["title"] = "other"
    result.save(tmp_path / "b.nc")
    assert load(tmp_path / "b.nc").dataset.attrs["title"] == "other"


def test_variables_that_are_missing_are_told(file, tmp_path):
    for name in ("state", "speed_ratio", "twist"):
        told = refusal(changed(file, tmp_path, lambda opened, name=name: opened.renameVariable(name, "stated")))
        assert f"damaged: {name} missing" in told


@pytest.mark.parametrize(
    ("change", "told"),
    [
        (lambda d: d.isel(time=slice(None, None, -1)), "time does not rise"),
        (lambda d: d.assign_coords(time=np.zeros(d.sizes["time"])), "time does not rise"),
        (lambda d: d.assign_coords(time=np.full(d.sizes["time"], np.nan)), "time is not a row of numbers"),
        (lambda d: d.assign_coords(time=d["time"].values ** 2), "samples are not equally far apart"),
        (lambda d: d.assign(parameter_value=d["parameter_value"] * np.nan), "parameters are not numbers"),
        (lambda d: d.drop_vars("mesh"), "the names of mesh are missing"),
        (lambda d: d.assign(mesh_force=d["mesh_force"].mean("mesh")), "mesh_force has dimensions time"),
        (lambda d: d.assign_coords(pin=["a"] * d.sizes["pin"]), "names of pin occur twice"),
        (lambda d: d.assign(steps=("time", ["x"] * d.sizes["time"])), "steps holds no numbers"),
    ],
)
def test_data_that_are_damaged_are_told(made, tmp_path, change, told):
    path = tmp_path / "changed.nc"
    change(made[3].dataset).to_netcdf(path)
    assert f"damaged: {told}" in refusal(path)


def test_sums_that_a_failed_run_spoils_are_no_damage(made, tmp_path):
    """A run that broke down may hold samples that are not finite; they are read."""
    spoilt = made[3].dataset.copy(deep=True)
    spoilt["mesh_force"][-3:] = np.nan
    spoilt.to_netcdf(tmp_path / "a.nc")
    assert np.isnan(load(tmp_path / "a.nc").dataset["mesh_force"].values[-1]).all()


@pytest.mark.parametrize("seed", range(12))
def test_data_that_were_overwritten_are_noticed(file, tmp_path, seed):
    """Every variable has a check sum: 3000 bytes set to zero anywhere in the data are told."""
    data, generator = bytearray(file.read_bytes()), np.random.default_rng(seed)
    with netCDF4.Dataset(file) as opened:
        assert all(opened[name].filters()["fletcher32"] for name in ("mesh_force", "state", "parameter_value"))
    wanted = load(file).dataset
    first = int(generator.integers(60_000, len(data) - 3000))
    data[first : first + 3000] = bytes(3000)
    damaged = tmp_path / "damaged.nc"
    damaged.write_bytes(bytes(data))
    try:
        found = load(damaged).dataset
    except LtcgearError:
        return
    assert found.equals(wanted)  # what was overwritten was no data


# --- access


def test_items_can_be_copied_and_pickled(made):
    item = made[3].mesh["hsp.sun_planet.1"]
    for other in (copy.copy(item), copy.deepcopy(item), pickle.loads(pickle.dumps(item))):
        assert other.force.equals(item.force)


def test_paths_may_be_text(made, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    made[3].save("a.nc")
    assert load("a.nc").dataset.equals(made[3].dataset)
    assert export(load("a.nc"), "a.csv", ["speed"]).stat().st_size > 1e3


@pytest.mark.parametrize(
    "arguments", [("export", "a.csv", "-o", "a.csv"), ("report", "a.html"), ("simulate", "a.nc", "-o", "a.nc")]
)
def test_what_is_read_is_not_overwritten(file, refused, tmp_path, monkeypatch, arguments):
    monkeypatch.chdir(tmp_path)
    source = tmp_path / arguments[1]
    shutil.copy(file, source)
    assert "is the file that is read; give another name" in refused(*arguments)
    assert source.read_bytes() == file.read_bytes()


# --- export


def test_csv_has_every_number_with_its_unit(made, file, run, tmp_path):
    target = tmp_path / "a.csv"
    code, out, err = run("export", str(file), "-o", str(target), "--output", "mesh_force", "--output", "speed:hsp.sun")
    assert (code, err) == (0, "")
    assert out == f"wrote {target}\n"
    heads = target.read_text().splitlines()[0].split(",")
    meshes = made[3].dataset["mesh"].values
    assert heads == ["time [s]", *(f"mesh_force:{mesh} [N]" for mesh in meshes), "speed:hsp.sun [rad/s]"]
    table = np.loadtxt(target, delimiter=",", skiprows=1)
    assert np.array_equal(table[:, 0], made[3].dataset["time"])
    assert np.array_equal(table[:, 1:-1], made[3].dataset["mesh_force"])
    assert np.array_equal(table[:, -1], made[3].rotor["hsp.sun"].speed)


def test_mat_has_matrices_names_and_units(made, file, run, tmp_path):
    target = tmp_path / "a.mat"
    code, _, err = run("export", str(file), "-o", str(target))
    assert (code, err) == (0, "")
    found = loadmat(target, simplify_cells=True)
    data = made[3].dataset
    moving = {str(name) for name, v in data.data_vars.items() if "time" in v.dims and name != "state"}
    assert moving <= set(found)
    assert np.array_equal(found["mesh_force"], data["mesh_force"])
    assert list(found["items"]["mesh_force"]) == list(data["mesh"].values)
    assert found["units"]["mesh_force"] == "N"
    assert np.array_equal(found["time"], data["time"])


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (("-o", "a.txt"), "a.txt: must end with .csv or .mat"),
        (("-o", "none/a.csv"), "does not exist; make it first"),
        (
            ("-o", "a.csv", "--output", "mesh_forces"),
            '--output mesh_forces: no such quantity; did you mean "mesh_force"?',
        ),
        (
            ("-o", "a.csv", "--output", "mesh_force:hsp"),
            "--output mesh_force:hsp: mesh_force has no such item; there are",
        ),
        (("-o", "a.csv", "--output", "steps:1"), "steps has no such item; there are none"),
    ],
)
def test_exports_that_cannot_be_are_refused(file, refused, tmp_path, monkeypatch, arguments, told):
    monkeypatch.chdir(tmp_path)
    assert told in refused("export", str(file), *arguments)
    assert list(tmp_path.iterdir()) == []
