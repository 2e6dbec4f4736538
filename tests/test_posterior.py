"""What targets leave open: closed forms for sums of squares with and without kinks."""

import numpy as np
import pytest
from benchmarks.identification.posterior import look_around, move_alone, polish, total
from ltcgear.generated.errors import SolverError

LOW, HIGH = np.full(2, -2.0), np.full(2, 2.0)
SLOPES = np.array([[3.0, 1.0], [0.5, -2.0], [0.0, 1.0]])
OFF = np.array([1.0, -2.0, 0.5])
Z = np.array([0.2, -0.3])


def level(z):
    """Targets that are linear in the unknowns."""
    return SLOPES @ z - OFF


def kinked(z):
    """The larger of two peaks: 4 units up to the left of 0.3, 1 down to the right of it; the least sum is at 0.3."""
    return np.array([max(4.0 * (0.3 - z[0]), 1.0 * (z[0] - 0.3)) + 0.5, z[1]])


def test_secants_of_a_line_are_its_slopes_and_stay_within_bounds():
    seen = []
    here = look_around(lambda z: seen.append(z.copy()) or level(z), np.array([1.95, -2.0]), LOW, HIGH)
    assert here.jacobian == pytest.approx(SLOPES)
    assert all(((z >= LOW) & (z <= HIGH)).all() for z in seen)
    hessian = SLOPES.T @ SLOPES + np.eye(2)
    assert here.covariance == pytest.approx(np.linalg.inv(hessian))
    assert here.determined == pytest.approx(2.0 - np.trace(np.linalg.inv(hessian)))


def test_the_sum_of_a_linear_model_rises_by_one_at_the_ends_of_both_ranges():
    best = np.linalg.solve(SLOPES.T @ SLOPES + np.eye(2), SLOPES.T @ OFF)
    here = look_around(level, best, LOW, HIGH)
    assert here.gradient == pytest.approx(0.0, abs=1e-12)
    base = total(level, best)
    for share in (1.0, -1.0, 2.0):
        end = here.follow(0, share)
        assert end[0] - best[0] == pytest.approx(share * here.narrowing[0])
        assert total(level, end) - base == pytest.approx(share**2)
    low, high = move_alone(level, best, 1, LOW, HIGH)
    alone = 1.0 / np.sqrt((SLOPES.T @ SLOPES + np.eye(2))[1, 1])
    assert (low, high) == pytest.approx((best[1] - alone, best[1] + alone), abs=alone / 50)
    assert high - best[1] < here.narrowing[1]  # the other one would have gone along


def test_a_secant_sees_both_sides_of_a_kink():
    here = look_around(kinked, np.array([0.3, 0.0]), LOW, HIGH)
    assert here.jacobian[0, 0] == pytest.approx((1.0 - 4.0) / 2)
    low, high = move_alone(kinked, np.array([0.3, 0.0]), 0, LOW, HIGH)
    assert total(kinked, np.array([low, 0.0])) == pytest.approx(0.34 + 1.0, rel=0.02)
    assert total(kinked, np.array([high, 0.0])) == pytest.approx(0.34 + 1.0, rel=0.02)
    assert 0.3 - low < 0.4 * (high - 0.3)  # steep to the left


def test_a_range_ends_at_a_bound_or_where_there_is_no_run():
    def cut(z):
        if z[0] > 0.5:
            raise SolverError("no run")
        return 0.01 * z

    low, high = move_alone(cut, np.zeros(2), 0, np.full(2, -0.7), HIGH)
    assert low == -0.7
    assert high == pytest.approx(0.5, abs=0.01)
    assert total(cut, np.array([1.0, 0.0])) == np.inf


def test_polishing_goes_down_to_the_kink_and_never_up():
    sums = []
    found = polish(kinked, np.array([-1.0, 0.8]), LOW, HIGH, lambda z: np.round(z, 4), told=sums.append)
    assert total(kinked, found) == pytest.approx(0.34, abs=0.02)
    assert sums == sorted(sums, reverse=True)
    assert (found == np.round(found, 4)).all()
    assert polish(kinked, np.array([0.3, 0.0]), LOW, HIGH, lambda z: z) == pytest.approx([0.3, 0.0])
    best = np.linalg.solve(SLOPES.T @ SLOPES + np.eye(2), SLOPES.T @ OFF)
    assert polish(level, Z, LOW, HIGH, lambda z: z) == pytest.approx(best, abs=1e-6)
