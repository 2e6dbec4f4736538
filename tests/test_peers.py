"""The peers of benchmarks/peers that need nothing installed: their forces are ours, and races are read off rightly."""

import ctypes
from importlib import import_module

import numpy as np
import pytest
from ltcgear.runtime.model.operating_point import OperatingPoint
from ltcgear.runtime.simulation.integrate import integrate
from ltcgear.runtime.simulation.run_settings import RunSettings
from scipy.integrate import DOP853

from regenerate import ROOT


@pytest.fixture(scope="module")
def peers():
    """Import a module of benchmarks/peers by its name."""
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(ROOT)
        yield lambda name: import_module(f"benchmarks.peers.{name}")


@pytest.fixture(scope="module")
def rig(peers):
    return peers("rig").open_rig()


def ours(peers, rig, rtol):
    times = peers("rig")
    return integrate(OperatingPoint(rig.library, rig.p, rig.at), RunSettings(times.T_END, times.RATE, "erk", rtol))


# --- forces


@pytest.mark.parametrize("merged", [False, True])
def test_c_by_hand_has_our_forces(peers, rig, merged):
    assert peers("rig").disagreement(rig, peers("floor").Floor(rig, merged)) < 1e-11


def test_every_number_of_the_c_by_hand_counts(peers, rig):
    """A hundredth more of any number but zero shows in the accelerations; directions of length 1 are left out."""
    floor, kind = peers("floor").Floor(rig), peers("floor").Parameters
    numbers = (ctypes.c_double * (ctypes.sizeof(kind) // 8)).from_buffer(floor.parameters)
    directions = range(kind.towards.offset // 8, (kind.towards.offset + kind.towards.size) // 8)
    unseen = []
    for i, value in enumerate(numbers):
        if abs(value) < 1e-12 or i in directions:
            continue
        numbers[i] = 1.01 * value
        with np.errstate(invalid="ignore"):
            unseen += [i] * (peers("rig").disagreement(rig, floor) < 1e-9)
        numbers[i] = value
    single = kind.h_ring.offset + peers("floor").Mesh.k2.offset
    assert unseen == [single // 8]  # the mesh of one level only has a second that nobody asks for
    assert peers("rig").disagreement(rig, floor) < 1e-11


def test_numpy_has_our_forces(peers, rig):
    assert peers("rig").disagreement(rig, peers("numpy_rig").NumpyRig(rig)) < 1e-11


def test_a_wrong_peer_is_refused(peers, rig):
    numpy = peers("numpy_rig").NumpyRig(rig)
    numpy.damping[3] *= 1 + 1e-5
    assert peers("rig").disagreement(rig, numpy) > peers("rig").AGREES


# --- switching instants and samples


def test_switching_instants_are_those_of_kinematics(peers, rig):
    run = ours(peers, rig, 1e-4)
    levels = np.array([segment.levels for segment in rig.segments])
    assert np.abs(np.diff(levels, axis=0)).sum() == run.counts.events == run.expected_events
    assert [s.end for s in rig.segments[:-1]] == [s.start for s in rig.segments[1:]]
    assert min(s.end - s.start for s in rig.segments) > 1e-9
    assert np.concatenate(rig.inside).tolist() == list(range(1, len(rig.times)))


def test_solvers_of_others_give_our_motion(peers, rig):
    solvers = peers("solvers")
    rate, jacobian = solvers.our_rate(rig), solvers.Jacobian(rig)
    reference = rig.forces(ours(peers, rig, 1e-8).x)
    found = {
        "LSODA": solvers.Odeint(rig, rate, jacobian), "DOP853": solvers.Stepwise(DOP853, rig, rate),
        "LSODA, no restarts": solvers.Odeint(rig, rate, restarts=False),
        "CVODE": solvers.Sundae("Adams", rig, rate, jacobian),
    }  # fmt: skip
    errors = {name: peers("rig").error(rig, solver.run(1e-6), reference) for name, solver in found.items()}
    assert all(0 < error < 3e-5 for error in errors.values()), errors


def test_our_jacobian_is_that_of_our_rate(peers, rig):
    solvers = peers("solvers")
    rate, jacobian = solvers.our_rate(rig), solvers.Jacobian(rig)
    x, levels = next(rig.states())
    direction = rig.scale * np.random.default_rng(3).normal(size=len(x))
    change = rate(x + 1e-3 * direction, levels).copy() - rate(x - 1e-3 * direction, levels)
    assert jacobian(x, levels) @ direction == pytest.approx(change / 2e-3, rel=1e-6, abs=1e-6 * np.abs(change).max())


# --- races


def test_time_at_an_error_lies_on_the_line_between_points(peers):
    time_at = peers("race").time_at
    law = [(10.0**-k, 0.01 * 10 ** (k / 5)) for k in (2, 3, 5, 6)]  # t = 0.01 e^(-1/5)
    assert time_at(law, 1e-4) == pytest.approx(0.01 * 10 ** (4 / 5))
    assert time_at(law[::-1], 1e-5) == pytest.approx(law[2][1])


def test_time_at_an_error_beyond_the_points(peers):
    time_at = peers("race").time_at
    assert time_at([(1e-2, 1.0), (1e-3, 2.0)], 1e-4) is None
    assert time_at([(1e-5, 3.0), (1e-6, 2.5)], 1e-4) == 2.5
    assert time_at([(1e-3, 5.0), (1e-5, 2.0)], 1e-4) == 2.0  # who is more accurate and quicker has both
    assert time_at([(np.nan, 1.0), (1e-5, 2.0)], 1e-4) == 2.0


def test_runners_take_turns_and_failures_are_told(peers):
    race, order = peers("race"), []

    def runner(name, seconds, rounds, fails=()):
        def run(setting):
            order.append((name, setting))
            if setting in fails:
                raise RuntimeError("first line\nstep too small")
            return np.array([setting]), seconds * (1 + len(order))

        return race.Runner(name, "solver", run, (1e-3, 1e-5), rounds)

    rows = race.race([runner("a", 1.0, 2), runner("b", 2.0, 1, fails=(1e-3,))], lambda x: float(x[0]))
    assert order == [("a", 1e-3), ("a", 1e-5), ("b", 1e-3), ("b", 1e-5), ("a", 1e-3), ("a", 1e-5)]
    assert [(p["setting"], p["runs"], p["min"]) for p in rows[0]["points"]] == [(1e-3, 2, 2.0), (1e-5, 2, 3.0)]
    assert rows[0]["points"][0]["median"] == 4.0
    assert rows[0]["reason"] == ""
    assert rows[1]["reason"] == "0.001: step too small"
    assert rows[1]["at_target"]["min"] == rows[1]["points"][0]["min"] == 10.0
    assert race.best(rows, "a")["tool"] == "a"
    assert race.best(rows, "c") is None


# --- the page


def test_verdicts_follow_from_the_numbers(peers):
    page, race, runners = peers("page"), peers("race"), peers("runners")

    def row(tool, solver, seconds):
        return {"tool": tool, "solver": solver, "at_target": {"min": seconds, "median": seconds}}

    rows = [row(runners.OURS, "erk", 0.01), row(runners.OURS, "cvodes", 0.1), row(runners.SCIPY, "A", 0.5)]
    rows += [row(runners.SCIPY, "B", 0.2), row(runners.NUMPY, "A", None)]
    making = {"our_stage": {"derive": 1.0, "compile": 2.0, "call": 1e-6}, "pydy_stage": {"stopped_after": 600}}
    loop = {name: {"min": seconds} for name, seconds in (("generated", 4e-7), ("written", 3.9e-7), ("merged", 2e-7))}
    lines = page.verdicts({"rig": {"rows": rows}, "making": making, "calls": {"loop": loop}}).splitlines()[2:]
    cells = [[cell.strip() for cell in line.strip("|").split("|")][1:4] for line in lines]
    assert race.best(rows, runners.SCIPY)["solver"] == "B"
    assert cells == [
        ["at least 10", "20", "yes"], ["at least 300", "-", "not measured"], ["at least 5", "-", "not measured"],
        ["at least 1", "-", "not measured"], ["at least 1", "-", "not measured"],
        ["at least 20", "more than 200", "yes"], ["at most 1.3", "1.03", "yes"], ["at most 1.3", "2", "no"],
    ]  # fmt: skip
