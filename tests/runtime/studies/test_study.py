"""Studies of accuracy: points that are timed, gaps with their reasons, the whole record."""

import json

import numpy as np
import pytest
from ltcgear.generated.errors import LtcgearError, MachineError, SolverError
from ltcgear.runtime.studies.accuracy.patience import OutOfTimeError, Patience
from ltcgear.runtime.studies.accuracy.presets import PRESETS, choose_time, mesh_rates
from ltcgear.runtime.studies.accuracy.reference import Reference, find_reference
from ltcgear.runtime.studies.accuracy.run_errors import value_of
from ltcgear.runtime.studies.accuracy.study import Wanted, run_study
from ltcgear.runtime.studies.accuracy.sweep import ROUNDS, Point, Sweep, choose_timed

from reference import gate

from .test_run_errors import RATE, bench_of


@pytest.fixture(scope="module")
def linear():
    """The torsional stage: its motion is known exactly."""
    return bench_of("psh", 'effects.lateral = "off"')


def test_points_that_cost_too_much_are_timed_once():
    points = [Point("erk", 10.0**-k, first=0.1 * k) for k in (4, 1, 2, 3)] + [Point("cvodes", 1e-3, "no")]
    assert [point.first for point in choose_timed(points, 2 * ROUNDS * 0.31)] == [0.1, 0.2]
    assert choose_timed(points, 0.0) == []
    assert choose_timed(points, 1e9) == points[:4]


def test_a_run_may_take_no_longer_than_it_may(linear):
    with pytest.raises(OutOfTimeError, match="more than 0 s for"):
        Patience(0.0).run(linear, "erk", 1e-9, t_end=50.0, rate=RATE)


def test_gaps_have_their_reasons(linear, monkeypatch):
    run = Patience.run

    def slow(self, bench, method, rtol, **options):
        if method == "cvodes" and rtol < 1e-3:
            raise OutOfTimeError("more than 1 s", 0.0)
        if method == "idas":
            raise LtcgearError("not for this model")
        return run(self, bench, method, rtol, **options)

    monkeypatch.setattr(Patience, "run", slow)
    sweep = Sweep(("erk", "cvodes", "idas"), (1e-3, 1e-4, 1e-5), 0.002, RATE, Patience(60.0), 0.0)
    points = sweep.measure(linear, Reference(None, [], {}, None, "none"))
    reasons = {(point.method, point.rtol): point.reason for point in points}
    assert [reasons["erk", rtol] for rtol in sweep.rtols] == [None] * 3
    assert reasons["cvodes", 1e-4] == "more than 1 s"
    assert reasons["cvodes", 1e-5] == "not run, since rtol 0.0001 took more than 1 s"
    assert [reasons["idas", rtol] for rtol in sweep.rtols] == ["not for this model"] * 3
    assert points[0].errors == {}
    assert points[0].counts["steps"] > 0


def test_a_fault_of_the_machine_is_no_method_s(linear, monkeypatch):
    def unable(self, bench, method, rtol, **options):
        raise MachineError("the store cannot be written")

    monkeypatch.setattr(Patience, "run", unable)
    options = {"t_end": 0.002, "rate": RATE}
    sweep = Sweep(("erk",), (1e-3,), 0.002, RATE, Patience(60.0), 60.0)
    for measure in (
        lambda: find_reference(linear, Patience(60.0), **options),
        lambda: sweep.measure(linear, Reference(None, [], {}, None, "none")),
        lambda: sweep._time(linear, Point("erk", 1e-3)),
        lambda: Patience(60.0).reach(linear, "erk", 1e-3, **options),
    ):
        with pytest.raises(MachineError, match="store"):
            measure()


def test_a_point_whose_repetition_fails_is_timed_once(linear, monkeypatch):
    run = Patience.run

    def failing(self, bench, method, rtol, **options):
        if method == "cvodes" and self.seconds == np.inf:
            raise SolverError("not again")
        return run(self, bench, method, rtol, **options)

    monkeypatch.setattr(Patience, "run", failing)
    sweep = Sweep(("erk", "cvodes"), (1e-3,), 0.002, RATE, Patience(60.0), 60.0)
    erk, cvodes = (p.to_json(0.002) for p in sweep.measure(linear, Reference(None, [], {}, None, "none")))
    assert (erk["rounds"], cvodes["rounds"], cvodes["reason"]) == (ROUNDS, 0, None)
    assert cvodes["seconds"] > 0


def test_a_study_is_a_whole_record(linear):
    told = []
    wanted = Wanted(
        "psh", "", "m", "n", RATE, 0.5, "quick", PRESETS["quick"], 0.01, ("erk", "rosenbrock"), (1e-3, 1e-6)
    )
    record = run_study(linear, wanted, told.append)
    assert told == sorted(told)
    assert told[-1] == pytest.approx(1.0)
    assert [(point["method"], point["rtol"]) for point in record["points"]] == [
        (method, rtol) for method in ("erk", "rosenbrock") for rtol in (1e-3, 1e-6)
    ]
    for point in record["points"]:
        assert point["rounds"] == ROUNDS
        assert 0 < point["seconds"] == point["integrator"]["min"] <= point["integrator"]["median"]
        assert point["user"]["min"] > 0
        assert point["ns_call"] == pytest.approx(1e9 * point["seconds"] / point["counts"]["rhs"])
        assert point["real_time_factor"] == pytest.approx(0.01 / point["seconds"])
        assert point["trusted"]
    loose, tight = (value_of(point["errors"], "mesh_force") for point in record["points"][:2])
    assert loose > 10 * tight > 0
    assert record["ns_rhs"] > 1
    assert [entry["error"] for entry in record["best"]] == [0.1, 0.01, 1e-3, 1e-4]
    assert record["machine"]["versions"]["casadi"] == "3.8.2"


def test_the_time_is_some_pitches_of_the_slowest_mesh():
    # Printed: 15 rpm of the ring, 118 teeth; Table 7 has 628.3 Hz for the pair.
    for scene, hertz in (("lsp", 29.5), ("psh", 628.3)):
        assert {round(rate, 1) for rate in mesh_rates(bench_of(scene))} == {hertz}
    slow, preset = bench_of("lsp"), PRESETS["full"]
    assert choose_time(slow, preset, 8192.0, 9.0) == pytest.approx(2.2 / 29.5, rel=1e-2)
    assert choose_time(slow, preset, 1024.0, 9.0) == 0.5  # 512 samples
    assert choose_time(slow, preset, 8192.0, 0.01) == 0.01
    assert choose_time(bench_of("hard-tiny-inertia"), preset, 2000.0, 0.05) == 0.05


def test_a_slow_scene_is_simulated_for_less_time(linear):
    assert Patience(60.0).reach(linear, "erk", 1e-6, t_end=0.02, rate=RATE) == 0.02
    shorter = Patience(0.3).reach(linear, "erk", 1e-9, t_end=50.0, rate=RATE)
    assert 64 / RATE <= shorter < 25.0
    assert shorter * RATE == pytest.approx(round(shorter * RATE), abs=1e-6)
    assert Patience(60.0).reach(linear, "adam", 1e-6, t_end=0.02, rate=RATE) == 0.02  # refused: told later, by points


def test_counts_and_errors_are_those_that_were_committed():
    committed, found = json.loads(gate.FILE.read_text("utf-8")), gate.measure()
    assert found.keys() == committed.keys()
    for name, point in committed.items():
        assert found[name]["events"] == point["events"]
        for count in gate.COUNTS:
            assert found[name][count] == pytest.approx(point[count], rel=0.1), (name, count)
        assert found[name]["error"] < 1.5 * point["error"], name
