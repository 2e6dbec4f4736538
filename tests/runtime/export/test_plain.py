"""Plain C: what a C program finds is what Python finds, with nothing but a C library."""

import ctypes
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from ltcgear.runtime.model.equilibrium import find_equilibrium
from ltcgear.runtime.model.phase_wrapping import TURN
from ltcgear.runtime.simulation.simulate import simulate

from ..models import MESHES, case
from ..plain import SANITIZERS, TAKER, One, can_sanitize, compiled, execute, forces, library, program, write
from ..variants import GRAVITY

BACKLASH = 'effects.contact = "backlash"'
GAPS = (
    BACKLASH, 'stages.psh.mesh.backlash = "0.2 mm"', 'effects.bearing_clearance = "on"',
    'stages.psh.input.bearing.clearance = "50 um"', 'stages.psh.output.bearing.clearance = "80 um"',
)  # fmt: skip
PLANETS = (BACKLASH, *(f'stages.{mesh}.backlash = "0.2 mm"' for mesh in MESHES["lsp"]))
MISPLACED = (
    'effects.lateral = "off"', 'loads.ring.speed = "300 rpm"', 'effects.planet_position_error = "on"',
    'stages.lsp.position_errors = [{planet = 1, radial = "60 um", tangential = "40 um"}]',
)  # fmt: skip
STEPPED = (
    "-loads.output.torque", 'loads.output.torque_over_time = [["0 s", "-10600 N*m"], ["1 s", "-10600 N*m"]]',
    "-loads.input.speed", 'loads.input.speed_over_time = [["0 s", "-600 rpm"], ["1 s", "-600 rpm"]]',
)  # fmt: skip
TOOTH = (
    'effects.mesh_stiffness = "fourier"', 'effects.tooth_errors = "on"', GRAVITY,
    'stages.lsp.sun_planet.tooth_errors = [{gear = "sun", tooth = 3, error = "30 um"}, '
    '{gear = "planet", tooth = 20, error = "-25 um"}]',
)  # fmt: skip


SETTLED = 0.2
"""Time after which vibrations of the start are gone [s]."""


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    return lambda name: tmp_path_factory.mktemp(name)


@pytest.fixture(scope="module")
def rig(place):
    found = case("rig-2mw")
    return found, program(write(found, place("rig")))


@pytest.fixture(scope="module")
def start_up(place):
    found = case("start-up")
    folder = write(found, place("start-up"))
    return found, program(folder), folder


@pytest.fixture(scope="module")
def gaps(place):
    found = case("psh", *GAPS)
    return found, library(found, place("gaps"))


TOLD = ("mean", "rms", "min", "max", "load_factor")


def means(found, t_end=None, rtol=1e-6, tables=None, raw=False, **changed):
    """Mesh -> statistics of its force in Python, as ``TOLD``."""
    values = found.model.values() | {name.replace("__", "."): value for name, value in changed.items()}
    simulation = found.scene.simulation
    options = {"t_end": t_end or simulation.t_end, "rate": simulation.rate, "method": "erk", "rtol": rtol, "raw": raw}
    result = simulate(found.library, values, **options, tables=tables or found.model.tables)
    assert result.summary["status"] == "done"
    return {mesh: np.array([force[name] for name in TOLD]) for mesh, force in result.summary["forces"].items()}


def agree(out, expected, extremes=1e-4):
    """Compare the statistics that were printed, extremes over the mean: Python looks at more points for its filter."""
    found = forces(out)
    assert found.keys() == expected.keys()
    for mesh, row in found.items():
        due, size = expected[mesh], abs(expected[mesh][0])
        assert row[0] == pytest.approx(due[0], rel=1e-8)
        assert row[1] == pytest.approx(due[1], rel=1e-6)
        assert row[2:4] == pytest.approx(due[2:4], abs=extremes * size)
        assert row[4] == pytest.approx(due[4], abs=extremes, nan_ok=True)


def test_the_rig_has_the_mesh_forces_of_simulate(rig):
    found, path = rig
    out, err = execute(path, "0.125")
    assert err == ""
    assert out.startswith("scene: 0.125 s simulated in ")
    agree(out, means(found, 0.125))
    agree(out, means(found, 0.125, raw=True), extremes=1e-7)
    path = found.run(method="erk", rtol=1e-6, t_end=0.125)
    steps, switchings = (int(part.split()[0]) for part in out.splitlines()[0].split("), ")[1].split(", "))
    assert (steps, switchings) == (pytest.approx(path.counts.steps, rel=0.01), path.counts.events)


def test_a_changed_parameter_changes_equilibrium_and_motion(rig):
    found, path = rig
    changes = {"loads__generator__torque": -5000.0, "psh__mesh__stiffness_double": 2e9}
    out, _ = execute(path, "0.0625", *(f"{name.replace('__', '.')}={value}" for name, value in changes.items()))
    agree(out, means(found, 0.0625, **changes), extremes=1e-3)  # one peak lies where the span begins
    row = forces(out)["psh.mesh"]
    assert row[0] == pytest.approx(5000 / 10600 * 118385, rel=0.05)
    assert row[4] == pytest.approx(row[3] / row[0], rel=1e-7)


def test_loads_over_time_and_backlash(start_up):
    found, path, _ = start_up
    agree(execute(path, "1")[0], means(found, 1.0))
    printed, due = forces_of(execute(path)[0]), {mesh: row[0] for mesh, row in means(found).items()}
    # In the end teeth rattle, and forget how they began: means are of the same size, and last digits part.
    assert printed == pytest.approx(due, abs=1e-3 * max(due.values()))
    assert min(due.values()) > 10


def test_a_program_needs_the_c_library_only(rig):
    if shutil.which("ldd") is None:
        pytest.skip("no ldd here")
    shown = subprocess.run(["ldd", str(rig[1])], capture_output=True, text=True, check=True).stdout
    needed = {Path(line.split()[0]).name.partition(".")[0] for line in shown.splitlines()}
    assert {"libc", "libm"} <= needed
    assert needed <= {"libc", "libm", "linux-vdso", "linux-gate", "ld-linux-x86-64", "ld-linux-aarch64"}


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["0"], "give a time"), (["-1"], "give a time"), (["1e9"], "give a time"), (["inf"], "write NAME=VALUE"),
        (["nan"], "write NAME=VALUE"), (["0.1", "0.2"], "write NAME=VALUE"), (["nosuch=1"], "no such parameter"),
        (["motor.inertia=x"], "no finite number"), (["motor.inertia=inf"], "no finite number"),
        (["motor.inertia=1e3x"], "no finite number"), (["motor.inertia="], "no finite number"),
        (["motor.speed_ratio=2"], "follows from the structure"), (["lsp.sun.mass=0"], "must be positive"),
        (["lsp.sun_planet.stiffness_single=-1"], "must not be negative"), (["motor.inertia=-1"], "must be positive"),
        (["psh.mesh.damping=-0.1"], "must not be negative"), (["psh.mesh.single_share=1"], "between 0 and 1"),
        (["psh.mesh.single_share=0"], "between 0 and 1"), (["psh.mesh.single_share=-1"], "between 0 and 1"),
        (["lsp.sun_planet.1.phase=0.2"], "follows from the structure"), (["origin=1"], "follows from the structure"),
    ],
)  # fmt: skip
def test_what_the_example_refuses(rig, arguments, told):
    out, err = execute(rig[1], *arguments, code=2)
    assert out == ""
    assert told in err
    assert len(err.splitlines()) == 1
    assert err.startswith(arguments[-1] + ": ")


ALONE = """
#include "ltcgear.h"
static ltcgear_model without_time;
static const ltcgear_model *const scene = &ltcgear_scene;
#define ltcgear_scene without_time
#define main example
#include "main.c"
#undef main
int main(void) {
  without_time = *scene;
  without_time.t_end = 0;
  return example(1, (char *[]){"gearbox", 0});
}
"""


def test_a_scene_without_time_is_refused_by_its_name(start_up):
    folder = start_up[2]
    (folder / "alone.c").write_text(ALONE, "utf-8")
    out, err = execute(compiled(folder, "alone", main="alone.c"), code=2)
    assert (out, err) == ("", "scene: give a time above 0, and below 1e7 s\n")


def test_nothing_holds_what_is_out_of_balance(place):
    found = case("psh", 'effects.contact = "one-flank"')
    plain = library(found, place("one-flank"))
    run = One(plain, found).put(loads__output__torque=10600.0)
    assert "nothing holds a member" in plain.reasoned(run.start(0.0))
    run.put(loads__output__torque=-20000.0).begun().close()


def test_sanitizers_find_nothing(start_up):
    folder = start_up[2]
    if not can_sanitize(folder):
        pytest.skip("no sanitizers here")
    out, err = execute(compiled(folder, "checked", *SANITIZERS), "0.5")
    assert err == ""
    assert forces_of(out) == pytest.approx(forces_of(execute(start_up[1], "0.5")[0]), rel=1e-6)
    (folder / "drive.c").write_text((Path(__file__).parent / "plain_drive.c").read_text("utf-8"), "utf-8")
    assert execute(compiled(folder, "drive", *SANITIZERS, main="drive.c")) == ("", "")


def forces_of(out):
    return {mesh: row[0] for mesh, row in forces(out).items()}


def test_a_run_without_end_is_refused(place):
    out, err = execute(program(write(case("hard-tiny-inertia"), place("tiny"))), "10", code=1)
    assert out == ""
    assert "one motion is so fast that" in err
    assert len(err.splitlines()) == 1


def test_parts_have_their_closed_forms(start_up):
    folder = start_up[2]
    (folder / "parts.c").write_text((Path(__file__).parent / "plain_parts.c").read_text("utf-8"), "utf-8")
    assert execute(compiled(folder, "parts", main="parts.c", kit=None)) == ("", "")


def test_the_program_of_the_page(start_up):
    folder = start_up[2]
    page = Path(__file__).parents[3] / "docs" / "plain-c.md"
    (folder / "own.c").write_text(page.read_text("utf-8").split("```c\n")[1].split("```")[0], "utf-8")
    out, err = execute(compiled(folder, "own", main="own.c"))
    assert err == ""
    assert [line.split(" N")[0].split(" s, ")[0] for line in out.splitlines()] == [f"{k / 100:g}" for k in range(1, 11)]
    assert all("mesh_force:pair.mesh: " in line for line in out.splitlines())


@pytest.mark.parametrize("factor", [1.0, 1.7, 1e-3, -1.0, -0.01])
@pytest.mark.parametrize("softer", [1.0, 0.3])
def test_equilibria_with_backlash_and_clearance(gaps, factor, softer):
    found, plain = gaps
    names = [name for name, _ in found.library.manifest.parameters]
    p = found.p.copy()
    p[names.index("loads.output.torque")] *= factor
    p[names.index("psh.input.bearing.stiffness")] *= softer
    run = One(plain, found).put(
        loads__output__torque=p[names.index("loads.output.torque")],
        psh__input__bearing__stiffness=p[names.index("psh.input.bearing.stiffness")],
    )
    expected = find_equilibrium(found.library, p).x
    assert np.abs(run.begun().x - expected).max() <= 1e-9 * np.abs(expected).max()
    if factor == softer == 1.0:
        assert np.abs(run.x - expected).max() <= 1e-15 * np.abs(expected).max()
    run.close()


def test_planets_change_flanks(place):
    found = case("lsp", *PLANETS)
    name = next(name for name, _ in found.library.manifest.parameters if name.endswith(".torque"))
    p = found.p * [-1.0 if name == known else 1.0 for known, _ in found.library.manifest.parameters]
    expected = find_equilibrium(found.library, p).x
    run = One(library(found, place("planets")), found).put(**{name: -found.model.values()[name]}).begun()
    assert np.abs(run.x - expected).max() <= 1e-9 * np.abs(expected).max()
    assert np.abs(expected - found.at.x).max() > 0.1 * np.abs(expected).max()
    run.close()


@pytest.fixture(scope="module", params=[(), TOOTH], ids=["plain", "teeth"])
def planets(request, place):
    found = case("lsp", *request.param)
    return found, library(found, place("turns"))


@pytest.mark.parametrize("speed", [400.0, -400.0])
def test_all_outputs_over_many_turns(planets, speed):
    found, plain = planets
    run = One(plain, found, 1e-9).put(reference__speed=speed).begun()
    rows = []

    def take(to, time, x, y):
        rows.append([time, *x[: len(found.library.manifest.states)], *y[: len(found.library.manifest.reports)]])
        return 0

    first = run.y
    assert run.record(0.05, 1000.0, TAKER(take), None) == 0
    last, rows = run.y, np.array(rows)
    run.close()
    values = found.model.values() | {"reference.speed": speed}
    result = simulate(found.library, values, t_end=0.05, rate=1000.0, method="erk", rtol=1e-9, raw=True).dataset
    assert rows[:, 0] == pytest.approx(np.arange(1, 51) / 1000, abs=1e-15)
    assert rows[:, 1] == pytest.approx(speed * rows[:, 0], rel=1e-12)
    assert abs(speed * 0.05) > 3 * TURN
    y = np.vstack([first, rows[:, 1 + len(found.library.manifest.states) :]])
    assert (y[-1] == last).all() or np.abs(y[-1] - last).max() <= 1e-9 * np.abs(last).max()
    for column, report in zip(y.T, found.library.manifest.reports, strict=True):
        expected = result[report.quantity].transpose("time", ...)
        expected = expected.values[:, list(expected[report.dimension].values).index(report.item)]
        assert np.abs(column - expected).max() <= 1e-5 * max(np.abs(result[report.quantity].values).max(), 1e-12), (
            report
        )


def test_loads_are_steered(place):
    found = case("psh", *STEPPED)
    plain = library(found, place("steered"))
    tables = {"loads.output.torque_over_time": [(0.0, -10600.0), (0.01, -10600.0), (0.02, 5300.0)],
              "loads.input.speed_over_time": [(0.0, -62.0), (0.015, -62.0), (0.03, -70.0)]}  # fmt: skip
    order = list(dict.fromkeys(signal.table for signal in found.library.manifest.signals))
    torque, speed = map(order.index, tables)
    run = One(plain, found, 1e-8)
    assert run.steer(speed, -62.0, -62.0, 0.0) == 0
    for time, which, values in ((0.01, torque, (-10600.0, 5300.0, 0.02)), (0.015, speed, (-62.0, -70.0, 0.03))):
        if time == 0.01:
            run.begun()
        assert run.advance(time) == 0
        assert run.steer(which, *values) == 0
    assert run.advance(0.04) == 0
    assert run.time() == 0.04
    options = {"t_end": 0.04, "rate": 1000.0, "method": "erk", "rtol": 1e-8, "tables": tables, "raw": True}
    result = simulate(found.library, found.model.values(), **options).dataset
    for name in ("mesh_force", "speed", "mesh_phase"):
        index = next(i for i, report in enumerate(found.library.manifest.reports) if report.quantity == name)
        expected = result[name].transpose("time", ...).values
        assert run.y[index] == pytest.approx(expected[-1, 0], rel=1e-6)
    assert abs(result["mesh_force"].values[5].max()) > 1.5 * abs(result["mesh_force"].values[-1].max())
    run.close()


def test_phases_of_misplaced_pins_go_on_over_the_turns(place):
    """Where gears only turn, such a mesh has two clocks, which take the same cycles off one level and two phases."""
    found = case("lsp", *MISPLACED)
    assert len(found.library.manifest.clocks) == 2 * len(found.library.manifest.levels)
    run = One(library(found, place("misplaced")), found, 1e-7).begun()
    assert run.advance(0.5) == 0
    options = {"t_end": 0.5, "rate": 1000.0, "method": "erk", "rtol": 1e-7}
    result = simulate(found.library, found.model.values(), **options)
    assert run.switchings() == result.summary["counts"]["events"] > 2000
    for name in ("mesh_phase", "gear_phase"):
        index = [i for i, report in enumerate(found.library.manifest.reports) if report.quantity == name]
        assert run.y[index] == pytest.approx(result.dataset[name].values[-1], abs=1e-6), name
        assert (run.y[index] > 200).all()
    run.close()


def test_pieces_make_the_same_motion(gaps):
    found, plain = gaps
    whole, pieces = (One(plain, found, 1e-9).put(loads__output__torque=-5000.0).begun() for _ in range(2))
    assert whole.advance(0.02) == 0
    for k in range(1, 41):
        assert pieces.advance(k * 0.0005) == 0
        assert pieces.time() == k * 0.0005
    assert whole.switchings() == pieces.switchings() > 10
    assert whole.x == pytest.approx(pieces.x, rel=1e-6, abs=1e-12)
    kept = pieces.saved()
    other = One(plain, found)
    assert other.restore(kept) == 0
    assert other.saved() == kept
    for run in (whole, pieces, other):
        run.close()


@pytest.fixture
def settled(gaps):
    """A run whose mesh does not part, some time after its start, with its mesh frequency [Hz] and static force [N]."""
    found, plain = gaps
    run = One(plain, found, 1e-8).begun()
    where = {report.quantity: i for i, report in reversed(list(enumerate(found.library.manifest.reports)))}
    first = run.y[where["mesh_phase"]]
    assert run.advance(SETTLED) == 0
    p = dict(zip(run.names, found.p, strict=True))
    static = abs(p["loads.output.torque"]) / p["psh.mesh.base_radius_2"]
    yield run, abs(run.y[where["mesh_phase"]] - first) / SETTLED, static, where["mesh_force"]
    run.close()


def test_means_are_those_of_statics_where_samples_fall_on_few_phases(settled):
    run, frequency, static, force = settled
    end, kept, samples = SETTLED + 80 / frequency, run.saved(), []

    def take(to, time, x, y):
        samples.append(y[force])
        return 0

    assert run.record(end, 4 * frequency, TAKER(take), None) == 0
    assert abs(np.mean(samples) / static - 1) > 1e-4
    assert run.restore(kept) == 0
    steady = run.measured(end, SETTLED + 40 / frequency)
    assert steady[0, 0] == pytest.approx(static, rel=1e-6)
    assert run.restore(kept) == 0
    whole = run.measured(end)
    assert whole[0, 0] == pytest.approx(static, rel=1e-6)
    assert whole[0, 2] < min(samples) < max(samples) < whole[0, 3]
    assert run.restore(kept) == 0
    parts = np.array([run.measured(SETTLED + k * (end - SETTLED) / 7) for k in range(1, 8)])[:, 0]
    assert parts[:, 0].mean() == pytest.approx(whole[0, 0], rel=1e-7)
    assert np.sqrt((parts[:, 1] ** 2).mean()) == pytest.approx(whole[0, 1], rel=1e-7)
    assert [parts[:, 2].min(), parts[:, 3].max()] == pytest.approx(whole[0, 2:], rel=1e-5)


def test_a_short_span_has_its_own_weights(settled):
    run, frequency, *_ = settled
    kept, until = run.saved(), SETTLED + 0.7 / frequency
    few = run.measured(until, SETTLED + 0.5 / frequency)
    assert run.restore(kept) == 0
    assert run.advance(SETTLED + 0.5 / frequency) == 0
    parts = np.arange(200)
    each = np.array([run.measured(SETTLED + (0.5 + 0.2 * (k + 1) / 200) / frequency)[0, 0] for k in parts])
    weights = np.sin(np.pi * (parts + 0.5) / 200) ** 4
    assert few[0, 0] == pytest.approx(each @ weights / weights.sum(), rel=1e-5)
    assert abs(few[0, 0] / each.mean() - 1) > 1e-3


def test_bytes_of_another_model_are_refused(gaps, start_up, place):
    found, plain = gaps
    own = One(plain, found).begun()
    other = One(library(start_up[0], place("other")), start_up[0])
    room = ctypes.create_string_buffer(own.saved(), max(own.size(), other.size()))
    assert "another" not in plain.reasoned(0)
    assert "not the bytes" in other.plain.reasoned(other.restore(room))
    own.close()
    other.close()
