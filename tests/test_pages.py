"""Tables of docs/: what they print is what the code computes."""

import json
import re
from importlib import import_module
from math import pi

import numpy as np
import pytest
from ltcgear.generated import store
from ltcgear.runtime.model.building import build
from ltcgear.runtime.model.equilibrium import find_equilibrium
from ltcgear.runtime.model.function import Kernel
from ltcgear.runtime.model.topology import Topology
from ltcgear.runtime.simulation.methods.registry import METHODS
from ltcgear.runtime.studies.accuracy.record import digest_numbers, read_record
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.emit.pipeline import obtain
from ltcgear.symbolic.scene.load import load_scene

from records import make_record
from regenerate import ROOT


@pytest.fixture(scope="module")
def benchmarks():
    """Import a module of benchmarks/ by its name."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(ROOT)
        yield lambda name: import_module(f"benchmarks.{name}")


def rows(page, name=""):
    """A table between the marks of a page, row by row, a list of cells each; and its lines."""
    text = page.PAGE.read_text("utf-8").split(page.BEGIN.format(name))[1].split(page.END.format(name))[0]
    lines = text.splitlines(keepends=True)[2:]
    return [[cell.strip() for cell in line.strip("|\n ").split("|")] for line in lines], lines


def numbers(cell):
    return np.array([float(part) for part in cell.split(",")])


def test_stiffness(benchmarks):
    table4 = benchmarks("table4")
    assert table4.PAGE.read_text("utf-8").split(table4.BEGIN)[1].split(table4.END)[0] == table4.table()


# --- floating


def loaded_shares(floating, scene, stiff):
    """Shares of the planets in the loaded equilibrium, from the equations themselves (nothing is compiled)."""
    model = build_model(load_scene(scene, floating.ERROR | (floating.STIFF if stiff else {})))
    library = build(obtain(model))
    assert library.path is None
    p = library.parameters(model.values())
    at = find_equilibrium(library, p)
    y = Kernel(library.functions["outputs"])(at.x, at.s, p)[0]
    reports = enumerate(library.manifest.reports)
    forces = [y[i] for i, r in reports if r.quantity == "mesh_force" and r.item.startswith("lsp.sun_planet")]
    return np.array(forces) / np.mean(forces)


def test_floating(benchmarks, monkeypatch):
    floating = benchmarks("floating")
    monkeypatch.setattr(store, "compiler", lambda: None)
    found, _ = rows(floating)
    assert [row[:2] for row in found] == [[s, sun] for s, _ in floating.CASES for sun in ("floating", "stiff bearing")]
    for scene, sun, printed, spread, _ in found:
        shares = loaded_shares(floating, scene, sun == "stiff bearing")
        assert numbers(printed) == pytest.approx(shares, abs=2e-3)
        assert float(spread) == pytest.approx(np.ptp(shares), abs=2e-3)


# --- friction


def test_friction_has_the_closed_forms(benchmarks):
    sliding = benchmarks("sliding")
    found, lines = rows(sliding)
    assert len(found) == 2 * len(sliding.CASES)
    for cells, line in zip(found, lines, strict=True):
        teeth = tuple(int(z) for z in cells[0].split(":"))
        assert teeth in sliding.CASES
        assert sliding.row(teeth, int(cells[2]), tuple(numbers(cells[3])), float(cells[6])) == line


def test_friction_is_what_a_run_gives(benchmarks):
    sliding = benchmarks("sliding")
    for cells in rows(sliding)[0]:
        teeth, sign = tuple(int(z) for z in cells[0].split(":")), 3 - 2 * int(cells[2])
        for sense, printed in zip((1, -1), numbers(cells[3]), strict=True):
            run = sliding.simulate(*teeth, sense * sliding.SPEED, sense * sign * sliding.TORQUE, pitches=2)
            assert (run.power < 0) == (sign > 0)  # a gear 2 that is driven takes power out
            assert run.factor == pytest.approx(printed, abs=1e-4)
            assert run.efficiency == pytest.approx(float(cells[6]), abs=1e-5)
        assert numbers(cells[3]) == pytest.approx(float(cells[4]), rel=5e-3)


@pytest.mark.parametrize(("a", "b"), [(0.7, 0.8), (0.5, 0.5 + 1e-9), (0.45, 1.3), (1.2, 0.6), (0.9, 0.9)])
def test_closed_forms_are_sums_over_the_path(benchmarks, a, b):
    sliding = benchmarks("sliding")
    x = np.linspace(-a, b, 1_000_001)
    single = (x > b - 1) & (x < 1 - a)
    linear = np.clip(np.minimum(x + a, b - x) / (a + b - 1), 0.0, 1.0)
    for form, part in ((sliding.linear, linear), (sliding.halves, np.where(single, 1.0, 0.5))):
        for u, z1 in ((21 / 59, 59), (-21 / 96, 96)):
            wanted = 2 * pi * abs(1 / u + 1) / z1 * np.trapezoid(part * np.abs(x), x)
            assert form(u, z1, a, b) == pytest.approx(wanted, rel=1e-5)


# --- stability


def test_tongues_are_those_of_first_order_and_of_the_multipliers(benchmarks):
    page = benchmarks("stability")
    found, _ = rows(page, "tongues")
    assert len(found) == page.TONGUES
    undamped, damped = page.opened("lsp", page.UNDAMPED), page.opened("lsp")
    for name, modes, speed, half, growth, by_multipliers, least in found:
        near = np.array([0.995, 1.005]) * float(speed) * page.RPM
        pair = [
            next(t for t in page.draw_up(*opened, near, np.array([1.0])).tongues if t.resonance.name == name)
            for opened in (undamped, damped)
        ]
        assert numbers(modes) == pytest.approx(np.array(pair[0].resonance.frequencies_hz), abs=0.06)
        assert float(speed) == pytest.approx(pair[0].speed / page.RPM, abs=0.06)
        assert float(half) == pytest.approx(float(pair[0].half_width(np.array(1.0))) / page.RPM, abs=0.01)
        assert float(growth) == pytest.approx(pair[0].coupling, abs=0.1)
        exact = page.find_multipliers(page.vary(*undamped, speed=pair[0].speed)).multipliers[0]
        assert exact.resonance.name == name
        assert float(by_multipliers) == pytest.approx(exact.growth, abs=0.1)
        assert float(least) == pytest.approx(pair[1].least, abs=0.1)


def test_the_rig_is_as_stable_as_the_page_says(benchmarks):
    page = benchmarks("stability")
    found, _ = rows(page, "rig")
    assert [row[0] for row in found] == [stage or "all" for stage in page.STAGES]
    for stage, period, jumps, largest, growth, frequency, undamped, _ in found[:3]:
        damped, free = page.rig(stage), page.rig(stage, page.UNDAMPED)
        assert [period, jumps, largest, growth, frequency, undamped] == list(page.row(stage, damped, free, None)[1:7])
        assert damped.stable
        assert free.stable
    whole = page.vary(*page.opened("rig-2mw"))  # its multipliers take half a minute
    assert [found[3][1], found[3][2]] == [f"{1e3 * whole.period:.4g}", str(len(whole.borders) - 1)]
    assert float(found[3][3]) == pytest.approx(np.exp(float(found[0][4]) * whole.period), rel=1e-3)


# --- hard cases


def test_hard_cases(benchmarks):
    hard = benchmarks("hard_cases")
    text = hard.PAGE.read_text("utf-8").split(hard.BEGIN)[1].split(hard.END)[0]
    cases, numbers = ([cells(line) for line in part.splitlines()] for part in text.split("\n\n")[1:3])
    assert cases[0] == ["case", "what is hard", "what passes", *hard.METHODS]
    assert [row[:3] for row in cases[2:]] == [[case.name, case.title, case.passes] for case in hard.CASES]
    assert {verdict for row in cases[2:] for verdict in row[3:]} <= {"ok", "slow", "refused"}
    assert numbers[0] == ["case", "finding", *hard.METHODS, "limit"]
    for i, method in enumerate(hard.METHODS):
        for row in cases[2:]:
            own = [line for line in numbers[2:] if line[0] == row[0] and line[1] != "seconds"]
            found = [(float(line[2 + i]), float(line[-1])) for line in own if line[2 + i] != "-"]
            assert found or row[3 + i] == "refused", (row[0], method)
            # Both are printed to two digits.
            assert all(value <= 1.01 * limit for value, limit in found), (row[0], method)
    assert hard.FIGURE.exists()


def cells(line):
    return [cell.strip() for cell in line.strip("| ").split(" | ")]


# --- accuracy


@pytest.mark.parametrize("name", ["rig", "smooth", "contact", "stiff"])
def test_accuracy(benchmarks, name):
    """Tables, and the numbers in the conclusions, are those of the records; each record is of the case's model."""
    accuracy = benchmarks("accuracy")
    record = read_record(accuracy.record_path(name))
    before, rest = accuracy.PAGE.read_text("utf-8").split(accuracy.BEGIN.format(name))
    printed, rest = rest.split(accuracy.END.format(name))
    conclusion = rest.split("\n## ")[0]
    assert printed == accuracy.table(record)
    assert conclusion == accuracy.correct(conclusion, record)
    assert accuracy.FASTEST.search(conclusion)
    assert accuracy.SLOWER.search(conclusion)
    assert f"images/accuracy-{name}.png" in before
    case = accuracy.CASES[name]
    scene = load_scene(case.scene, dict(case.changes))
    assert record["numbers"] == digest_numbers(scene.model_dump_json(exclude_none=True))
    assert {point["method"] for point in record["points"]} == set(METHODS)
    assert [entry["method"] for entry in record["best"]].count(None) == 0
    assert record["reference"]["floor"] <= 1e-8


def test_numbers_in_conclusions_are_corrected(benchmarks):
    accuracy, record = benchmarks("accuracy"), make_record()
    text = "So. For 0.01 % `{}` is the fastest, {} times real time; `erk` takes {} times as long as `cvodes` for 0.1 %."
    text += " `erk` at rtol 1e-5 is off by {} in mesh force."
    assert accuracy.correct(text.format("idas", 7, 9, 1), record) == text.format("erk", 0.12, 1.3, "5.0e-04")


# --- long runs


def test_mean_forces_do_not_drift(benchmarks):
    """The benchmark's run, a hundredth as long, without a compiler."""
    long_run = benchmarks("long_run")
    found = long_run.run(long_run.SMOOTH, 300)
    assert found.path.turns[-1] > 250
    assert np.abs(found.path.phi).max() < 2 * pi * 18
    assert long_run.drift(found, 64) < 1e-9
    start = found.forces[: 64 // long_run.APART].mean(axis=0)
    assert np.abs(start / found.means(64)[1] - 1).max() > 1e-6  # the start itself is seen


def test_the_page_of_long_runs_tells_what_was_asked_for(benchmarks):
    long_run = benchmarks("long_run")
    cells = {row[0]: row[1] for row in rows(long_run)[0] if len(row) == 2}
    assert int(cells["pitches"]) == long_run.TURNS * long_run.TEETH >= 118 * 10**5
    drifts = [float(value) for key, value in cells.items() if key.startswith("mean force")]
    assert len(drifts) == 1
    assert drifts[0] < 1e-9
    assert cells["switchings"] == cells["switchings by kinematics"]
    seconds = round(long_run.SWITCHED_TURNS * long_run.PERIOD / long_run.SPACING) * long_run.SPACING
    assert int(cells["switchings"]) == pytest.approx(seconds / long_run.PERIOD * long_run.TEETH * 16, abs=16)


# --- dead band


def test_jumps_are_those_of_every_method_and_of_the_reference(benchmarks):
    dead_band = benchmarks("dead_band")
    found, _ = rows(dead_band, "methods")
    assert {"erk", "cvodes"} <= {name for name, *_ in found}
    pair = dead_band.scene()
    for name, *printed in found:
        jumps = dead_band.jumps(pair, name) if name in dead_band.METHODS else dead_band.JUMPS
        assert [float(cell) for cell in printed] == pytest.approx(jumps, rel=1e-4)
        assert jumps == pytest.approx(dead_band.JUMPS, rel=2e-3)


def test_a_slow_sweep_jumps_where_the_page_says(benchmarks):
    dead_band = benchmarks("dead_band")
    found, _ = rows(dead_band, "rates")
    *measured, limit = found
    assert [float(row[0]) for row in measured] == list(dead_band.RATES)
    assert [float(row[i]) for i in (1, 3) for row in measured[:1]] == pytest.approx(
        dead_band.slow_jumps(dead_band.scene(), dead_band.RATES[0]), rel=1e-4
    )
    for column in (1, 3):
        off = [abs(float(row[column]) / float(limit[column]) - 1) for row in measured]
        # the delay goes with the rate to the power of 2/3
        assert off[1] / off[3] == pytest.approx(10 ** (2 / 3), rel=0.35)
        assert [abs(float(row[column + 1].strip("+-% "))) for row in measured] == pytest.approx(
            [100 * value for value in off], abs=0.15
        )


# --- peers


def test_the_page_of_the_peers_is_of_its_data(benchmarks):
    page, rig = benchmarks("peers.page"), benchmarks("peers.rig")
    data = page.read()
    text = page.PAGE.read_text("utf-8").split(page.BEGIN)[1].split(page.END)[0]
    assert text == page.tables(data)
    assert page.FIGURE.exists()
    assert all(value <= rig.AGREES for value in data["checks"].values())


def test_the_page_of_the_peers_holds_all(benchmarks):
    data, runners = benchmarks("peers.page").read(), benchmarks("peers.runners")
    tools = {key: {row["tool"] for row in data[key]["rows"]} for key in ("rig", "stage", "torsion")}
    assert data["left_out"] == []
    assert tools["rig"] == {runners.OURS, runners.SCIPY, runners.NUMPY, runners.SUNDAE}
    assert tools["stage"] == tools["torsion"] == {runners.OURS, runners.EXUDYN}
    assert all(data[key]["uncertainty"] < 1e-6 for key in tools)
    assert len(data["checks"]) == 6  # two in C, NumPy, two of Exudyn, PyDy


# --- ensembles


def test_the_page_of_ensembles_tells_what_was_measured(benchmarks):
    ensemble = benchmarks("ensemble")
    data = json.loads(ensemble.DATA.read_text("utf-8"))
    text = ensemble.PAGE.read_text("utf-8").split(ensemble.BEGIN)[1].split(ensemble.END)[0]
    assert text == ensemble.table(data)
    assert tuple(data["scenes"]) == ensemble.SCENES
    for found in data["scenes"].values():
        assert found["runs"] == ensemble.RUNS
        # More workers do not cost more work.
        assert ensemble.least(found, "several", "cpu") < 1.15 * ensemble.least(found, "one", "cpu")


# --- your own solver


def test_the_page_of_calls_tells_what_was_measured(benchmarks):
    page, marks = benchmarks("callable"), benchmarks("marks")
    data = json.loads(page.DATA.read_text("utf-8"))
    assert marks.take(page.PAGE, "overhead") == page.scene_table(data)
    assert marks.take(page.PAGE, "ways") == page.way_table(data)
    assert tuple(data["scenes"]) == page.SCENES
    for found in data["scenes"].values():
        assert 0 < page.overhead(found) < 1500  # ns, as measured then
        assert page.overhead(found, "held") < page.overhead(found, "kernel")


# --- sweeps


def test_the_page_of_sweeps_tells_what_was_measured(benchmarks):
    page, marks = benchmarks("sweep"), benchmarks("marks")
    data = json.loads(page.DATA.read_text("utf-8"))
    assert marks.take(page.PAGE, "cost").strip() == page.write(data).strip()
    assert page.POINTS == 1000
    assert data["one"] > 1.8 * data["two"]
    assert data["point"] < 1.1 * data["alone"]


# --- modes


def test_modes_of_the_rig_are_those_of_the_page(benchmarks):
    page = benchmarks("modes")
    scene, linear, modes = page.rig()
    table = page.list_table(modes, Topology(linear.library.manifest))
    made = {"list": table, "lines": page.line_table(scene, modes), "explained": page.explained(scene)}
    for name, part in made.items():
        assert benchmarks("marks").take(page.PAGE, name) == part
    assert page.FIGURE.exists()


def test_lines_of_table_8_are_listed_once_each(benchmarks):
    page = benchmarks("modes")
    found = page.lines(load_scene("rig-2mw"))
    assert {62.5, 114.4, 557.5} <= {value for value, (name, _) in found.items() if not name}
    assert {value: found[value][0] for value in (29.5, 158.7, 316.2, 628.1)} == {
        29.5: "1 lsp", 158.7: "1 hsp", 316.2: "2 hsp", 628.1: "1 psh",
    }  # fmt: skip


def test_what_modes_take_is_what_was_measured(benchmarks):
    page = benchmarks("modes")
    data = json.loads(page.DATA.read_text("utf-8"))
    assert benchmarks("marks").take(page.PAGE, "times") == page.time_table(data)
    assert data["cases"]["long"]["members"] > 200
    assert data["cases"]["rig-2mw"]["count"] is None


# --- resonance


def test_resonances_of_the_rig(benchmarks):
    resonance = benchmarks("resonance")
    made = resonance.table(resonance.campbell()).splitlines()[2:]
    found, _ = rows(resonance)
    assert len(found) == len(made) == resonance.ROWS
    for page, line in zip(found, made, strict=True):
        now = [cell.strip() for cell in line.strip("| ").split("|")]
        assert (page[0], page[4]) == (now[0], now[4])
        for place in (1, 2, 5, 6):
            assert float(page[place]) == pytest.approx(float(now[place]), rel=1e-3, abs=0.011)


# --- sensitivities


def test_sensitivities(benchmarks):
    page = benchmarks("sensitivities")
    modes, output = page.measure()
    for name, made in (("modes", page.modes_table(modes)), ("output", page.output_table(output))):
        _, lines = rows(page, name)
        wanted = made.splitlines(keepends=True)[2:]
        assert len(lines) == len(wanted)
        for line, other in zip(lines, wanted, strict=True):
            one, two = (re.split(r"([+-]?\d+\.\d+)", text) for text in (line, other))
            assert one[::2] == two[::2]
            assert [float(v) for v in one[1::2]] == pytest.approx([float(v) for v in two[1::2]], rel=1e-3, abs=2e-3)
