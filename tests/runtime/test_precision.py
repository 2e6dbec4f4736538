"""What accuracy costs: errors of known perturbations, what the reference is worth, points that run and that do not."""

import json
from dataclasses import replace
from math import log10, pi, sqrt

import numpy as np
import pytest
from ltcgear.generated.errors import LtcgearError, MachineError, SolverError
from ltcgear.runtime.studies.accuracy import reference as references
from ltcgear.runtime.studies.accuracy.patience import OutOfTimeError, Patience
from ltcgear.runtime.studies.accuracy.presets import PRESETS, choose_time, mesh_rates
from ltcgear.runtime.studies.accuracy.reference import MARGIN, Reference, find_reference, judge
from ltcgear.runtime.studies.accuracy.run_errors import KINDS, ComparedSamples, find_errors, take_samples, value_of
from ltcgear.runtime.studies.accuracy.study import Wanted, run_study
from ltcgear.runtime.studies.accuracy.sweep import ROUNDS, Point, Sweep, choose_timed
from ltcgear.runtime.studies.selftest.case import Bench

from reference import gate

from .models import case

RATE = 4096.0
TIME = np.arange(4096) / RATE
PHASE = 40 * TIME
SWING = np.sin(2 * pi * PHASE)
OTHER = np.cos(2 * pi * 3 * PHASE)
SUNS = ("a.sun_planet.1", "a.sun_planet.2")


def samples(one=0.0, two=0.0, bearing=0.0, twist=0.0, state=0.0, dead=0.0):
    """Two planets' mesh forces of 100 and 80 N with swings of 10 and 8, a bearing, a member; and what is added."""
    forces = {SUNS[0]: 100 + 10 * SWING + one, SUNS[1]: 80 + 8 * SWING + two}
    bearings = {"b": (30 + 5 * SWING) + 1j * (40 + 5 * OTHER) + bearing, "c": 1e-9 * OTHER + dead}
    return ComparedSamples(
        np.zeros((len(TIME), 1)), {"x": SWING + state, "y": SWING},
        {"mesh_force": forces, "bearing_force": bearings, "transmission_error": {"m": 1e-3 * (2 + SWING) + twist}},
        dict.fromkeys(SUNS, PHASE), [list(SUNS)],
    )  # fmt: skip


# --- errors


def test_the_same_run_has_no_errors():
    found = find_errors(samples(), samples())
    assert {kind: value_of(found, kind) for kind in KINDS} == dict.fromkeys(KINDS, 0.0)
    assert found["apart"] == 0.0


def test_errors_are_those_that_were_put_in():
    found = find_errors(samples(), samples(two=0.16 * OTHER, bearing=0.1 * SWING, twist=1e-5, state=0.2 * OTHER))
    mesh = found["mesh_force"]
    assert mesh["item"] == SUNS[1]
    assert mesh["rms_over_vibration"] == mesh["value"] == pytest.approx(0.16 / 8, rel=1e-6)
    assert mesh["peak_over_vibration"] == pytest.approx(0.16 / (8 / sqrt(2)), rel=1e-3)
    assert mesh["rms_over_mean"] == pytest.approx(0.16 / sqrt(2) / 80, rel=1e-6)
    assert mesh["peak_over_mean"] == pytest.approx(0.16 / 80, rel=1e-3)
    bearing = found["bearing_force"]
    assert bearing["item"] == "b"
    assert bearing["value"] == pytest.approx((0.1 / sqrt(2)) / 5, rel=1e-6)  # 5 = sqrt(5^2 / 2 + 5^2 / 2)
    assert bearing["rms_over_mean"] == pytest.approx((0.1 / sqrt(2)) / 50, rel=1e-6)  # 30 and 40 make 50
    assert value_of(found, "transmission_error") == pytest.approx(1e-5 / (1e-3 / sqrt(2)), rel=1e-6)
    assert found["states"] == {"value": pytest.approx(0.2 / sqrt(2), rel=1e-6), "item": "x"}


def test_load_share_and_spectrum():
    found = find_errors(samples(), samples(one=-1 + 0.1 * SWING, two=1.0))
    assert value_of(found, "load_share") == pytest.approx(1 / 90, rel=1e-6)
    assert found["spectrum"]["value"] == pytest.approx(20 * log10(10.1 / 10), rel=1e-3)
    assert (found["spectrum"]["item"], found["spectrum"]["order"]) == (SUNS[0], 1)


def test_forces_that_cancel_are_no_vibration():
    """Bearing c carries rounding alone, and an error of its own size must not count."""
    assert value_of(find_errors(samples(), samples(dead=1e-9 * SWING)), "bearing_force") == 0.0


def test_samples_on_a_jump_are_left_out():
    here = np.isin(np.arange(len(TIME)), (100, 2000))
    run = samples(one=np.where(here, 50.0, 0.0))
    assert value_of(find_errors(samples(), run), "mesh_force") > 0.1
    jumped = replace(run, levels=here[:, None].astype(float))
    found = find_errors(samples(), jumped)
    assert value_of(found, "mesh_force") == value_of(found, "spectrum") == 0.0
    assert found["apart"] == 2 / len(TIME)


def test_a_trajectory_is_read_by_name():
    bench = bench_of("hsp")
    path = bench.run("erk", t_end=0.02, rate=RATE, rtol=1e-5)
    scale = bench.point.scale
    i = case("hsp").state("hsp.sun.u")
    x = path.x.copy()
    x[:, i] += 0.25 * scale[i]
    one, two = take_samples(bench, path), take_samples(bench, replace(path, x=x))
    found = find_errors(one, two)
    assert found["states"] == {"value": pytest.approx(0.25), "item": "hsp.sun.u"}
    assert found["transmission_error"]["item"] == "hsp.sun"
    assert all("planet" not in name for name in one.signals["transmission_error"])
    assert found["mesh_force"]["item"].startswith("hsp.sun_planet")  # the sun does not mesh with the ring
    assert {"hsp.pin.1", "hsp.sun"} <= set(one.signals["bearing_force"])


def bench_of(name, *settings):
    found = case(name, *settings)
    return Bench(found.library, found.model.values(), found.model.tables)


# --- the reference


@pytest.fixture(scope="module")
def linear():
    """The torsional stage: its motion is known exactly."""
    return bench_of("psh", 'effects.lateral = "off"')


def test_the_reference_knows_its_own_uncertainty(linear):
    found = find_reference(linear, Patience(60.0), t_end=0.02, rate=RATE)
    assert found.reason is None
    assert [run["method"] for run in found.runs] == ["erk", "rosenbrock"]
    true = value_of(found.exact, "mesh_force")
    assert 0 < true <= found.floor < 1e-8
    # Both read samples between the same nodes, so that their difference alone would promise too much.
    assert value_of(found.uncertainty, "mesh_force") < true <= replace(found, exact=None).floor
    assert found.trusts({"mesh_force": {"value": MARGIN * found.floor}})
    assert not found.trusts({"mesh_force": {"value": 0.99 * MARGIN * found.floor}})


def test_without_two_methods_there_is_no_reference(linear, monkeypatch):
    monkeypatch.setattr(references, "reference_methods", lambda: ["erk"])
    found = find_reference(linear, Patience(60.0), t_end=0.005, rate=RATE)
    assert "fewer than two methods" in found.reason
    assert found.samples is None
    slow = find_reference(linear, Patience(0.0), t_end=50.0, rate=RATE)
    assert "fewer than two methods" in slow.reason
    assert len(slow.failures) == len(references.RTOLS)
    assert "more than 0 s" in slow.failures[0]


def judged(one, two):
    runs = [{"method": method, "rtol": 1e-13, "seconds": 1.0} for method in ("erk", "rosenbrock")]
    return judge([one, two], Reference(one, runs, find_errors(one, two), None, None), 1.0)


def test_runs_that_part_are_no_reference():
    apart = judged(samples(), samples(one=1e-9 * np.exp(24 * TIME) * OTHER))
    assert apart.samples is None
    assert "the two runs part" in apart.reason
    assert "only statistics" in apart.reason
    assert "uncertain by 2.0e-02" in judged(samples(), samples(one=0.2 * OTHER)).reason
    still = replace(samples(), signals={kind: {} for kind in samples().signals}, states={}, groups=[])
    assert "nothing moves" in judged(still, still).reason
    rounding = replace(samples(), states={"x": 1e-9 * SWING, "phi": 100 * TIME}, reference=("phi",))
    assert "nothing moves" in judged(rounding, rounding).reason
    assert judged(samples(), samples(one=1e-9 * OTHER)).reason is None


def test_a_scene_without_meshes_is_judged_by_its_twist():
    shafts = replace(samples(), signals=samples().signals | {"mesh_force": {}}, phases={}, groups=[])
    assert judged(samples(), samples()).measure == "mesh_force"
    assert judged(shafts, shafts).measure == "transmission_error"


# --- points


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


# --- no slower and no worse than it was


def test_counts_and_errors_are_those_that_were_committed():
    committed, found = json.loads(gate.FILE.read_text("utf-8")), gate.measure()
    assert found.keys() == committed.keys()
    for name, point in committed.items():
        assert found[name]["events"] == point["events"]
        for count in gate.COUNTS:
            assert found[name][count] == pytest.approx(point[count], rel=0.1), (name, count)
        assert found[name]["error"] < 1.5 * point["error"], name
