"""The reference of a study of accuracy, and when there is none."""

from dataclasses import replace

import numpy as np
import pytest
from ltcgear.runtime.studies.accuracy import reference as references
from ltcgear.runtime.studies.accuracy.patience import Patience
from ltcgear.runtime.studies.accuracy.reference import MARGIN, Reference, find_reference, judge
from ltcgear.runtime.studies.accuracy.run_errors import find_errors, value_of

from .test_run_errors import OTHER, RATE, SWING, TIME, bench_of, samples


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
