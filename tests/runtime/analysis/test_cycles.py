"""Rainflow cycles and equivalent ranges, against a standard's example and closed forms."""

import sys

import numpy as np
import pytest
from ltcgear.generated.errors import LtcgearError
from ltcgear.runtime.analysis import (
    count_cycles,
)

from ..outputs import output, times

TIME = times()
TURN = 2 * np.pi
WAVE = np.sin(TURN * 8.0 * TIME)
ASTM = (-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0, -2.0)


def test_the_example_of_the_standard():
    """ASTM E1049-85 (2017), Fig. 6: ranges 3, 4, 6, 8, 9 with 0.5, 1.5, 0.5, 1.0, 0.5 cycles."""
    at = (np.arange(9) * (TIME.size - 1)) // 8  # peaks fall on samples
    found = count_cycles(output(np.interp(np.arange(TIME.size), at, ASTM), TIME))
    summed = {round(r, 9): float(found.count[np.isclose(found.span, r)].sum()) for r in found.span}
    assert summed == {3.0: 0.5, 4.0: 1.5, 6.0: 0.5, 8.0: 1.0, 9.0: 0.5}
    assert found.mean[np.isclose(found.span, 9.0)] == pytest.approx([0.5])
    assert (found.total, found.largest) == (4.0, 9.0)
    edges, count = found.by_range(9)
    assert edges == pytest.approx(np.arange(10.0))
    assert list(count) == [0.0, 0.0, 0.0, 0.5, 1.5, 0.0, 0.5, 0.0, 1.5]
    assert found.by_range_and_mean()[2].sum() == pytest.approx(4.0)
    cubes = (0.5 * 3.0**3 + 1.5 * 4.0**3 + 0.5 * 6.0**3 + 8.0**3 + 0.5 * 9.0**3) / 7.0
    assert found.equivalent(3.0, 7.0) == pytest.approx(cubes ** (1 / 3))


def test_a_sine_is_its_own_cycles():
    found = count_cycles(output(50.0 + 20.0 * WAVE, TIME))
    assert found.total == pytest.approx(8.0, abs=0.51)
    assert found.span[found.span > 30.0] == pytest.approx(40.0, rel=1e-3)
    # 7.5 cycles of 40, and what is left at the ends: two half cycles of 20.
    assert found.equivalent(5.0, 8.0) == pytest.approx(((7.5 * 40.0**5 + 20.0**5) / 8.0) ** 0.2, rel=1e-3)


def test_ripple_adds_to_the_equivalent_range():
    """By Miner's rule what is added does damage; two loads are ranked by their damage over one count."""
    plain, other = (count_cycles(output(50.0 + size * WAVE, TIME)) for size in (20.0, 17.0))
    rippled = count_cycles(output(50.0 + 20.0 * WAVE + 2.0 * np.sin(TURN * 500.0 * TIME), TIME))
    assert rippled.total > 10.0 * plain.total
    equivalents = [one.equivalent(6.0, 8.0) for one in (other, plain, rippled)]
    damages = [float((one.count * one.span**6.0).sum()) for one in (other, plain, rippled)]
    assert equivalents == sorted(equivalents)
    assert damages == sorted(damages)
    assert np.array(equivalents) ** 6.0 * 8.0 == pytest.approx(damages)


@pytest.mark.parametrize(("exponent", "reference"), [(6.0, 0.0), (0.0, 8.0), (6.0, float("nan"))])
def test_an_equivalent_range_needs_a_count_and_a_slope(exponent, reference):
    with pytest.raises(LtcgearError, match=r"equivalent range: slope .* both must be above zero"):
        count_cycles(output(WAVE, TIME)).equivalent(exponent, reference)


def test_a_constant_load_has_no_cycles():
    found = count_cycles(output(np.ones_like(TIME), TIME))
    assert (found.total, found.largest, found.equivalent(3.0, 8.0)) == (0.0, 0.0, 0.0)
    assert found.by_range()[1].sum() == 0.0


def test_without_the_library_the_cure_is_told(monkeypatch):
    monkeypatch.setitem(sys.modules, "rainflow", None)
    with pytest.raises(LtcgearError, match=r"pip install 'ltcgear\[report\]'"):
        count_cycles(output(WAVE, TIME))
