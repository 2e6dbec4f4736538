"""Order spectra of shafts whose speed varies."""

import numpy as np
import pytest
from ltcgear.generated.errors import LtcgearError
from ltcgear.runtime.analysis import (
    find_clues,
    find_order_spectrum,
    find_spectrum,
)
from ltcgear.runtime.analysis.order_spectrum import choose_shaft

from ..outputs import output, result, times

TIME = times()
TURN = 2 * np.pi


def test_orders_end_with_the_band():
    time, angle, _ = run_up(20.0, 40.0)
    signal, shaft = output(np.sin(7.0 * angle), time), output(angle, time, "angle", "sun")
    assert find_order_spectrum(signal, shaft, highest_hz=1000.0).axis[-1] == pytest.approx(25.0, rel=1e-2)


def test_gears_count_against_the_carrier_that_turns_and_planets_only_so():
    """A planet of a stage whose carrier stands turns against it as it turns; a sun is then not told twice."""
    speeds = {"s.sun": 300.0, "s.carrier": 90.0, "s.planet.1": -200.0, "s.planet.2": -200.0, "s.ring": 0.0,
              "t.sun": 50.0, "t.carrier": 0.0, "t.planet.1": -70.0}  # fmt: skip
    clues = find_clues(result(TIME, speed=speeds))
    turns = {"s.sun": 300.0, "t.sun": 50.0, "s.sun/carrier": 210.0, "s.planet/carrier": 290.0, "t.planet/carrier": 70.0}
    assert clues.carriers == pytest.approx({"s.carrier": 90.0 / TURN})
    assert clues.shafts == pytest.approx({name: value / TURN for name, value in turns.items()})


def test_orders_are_over_the_fastest_rotor_that_is_no_planet():
    speeds = {"s.sun": 1.0, "s.planet.1": -9.0, "s.carrier": -3.0, "t.output": 5.0, "u.planet.1": 7.0}
    dataset = result(TIME, speed=speeds)
    assert [choose_shaft(dataset, stage) for stage in ("s", "t", "u", "")] == ["s.carrier", *3 * ["t.output"]]
    assert choose_shaft(result(TIME, speed={"u.planet.1": 7.0})) == "u.planet.1"
    assert choose_shaft(result(TIME, mesh_force={"a": 1.0})) is None


def run_up(first, last, seconds=2.0):
    """Time, angle [rad] and speed [rad/s] of a shaft that speeds up evenly from one to another [turns a second]."""
    time = times(seconds)
    turns = first * time + 0.5 * (last - first) / seconds * time**2
    return time, TURN * turns, TURN * (first + (last - first) / seconds * time)


def test_a_chirp_is_one_order():
    time, angle, _ = run_up(5.0, 40.0)
    signal = output(2.0 + 3.0 * np.sin(7.0 * angle), time)
    found = find_order_spectrum(signal, output(angle, time, "angle", "sun"))
    assert (found.axis_unit, found.shaft, found.resolution) == ("1", "sun", pytest.approx(1 / 44))
    peak = int(np.argmax(found.value[1:])) + 1
    assert found.axis[peak] == pytest.approx(7.0, abs=1e-9)
    assert found.value[peak] == pytest.approx(3.0, rel=1e-4)
    assert np.delete(found.value[1:], np.arange(peak - 3, peak + 2)).max() < 3e-3 * 3.0
    smeared = find_spectrum(signal)
    assert smeared.value[1:].max() < 0.5 * 3.0


def test_orders_end_at_the_margin_and_nothing_folds_back():
    """A tone at a fixed frequency is a band of orders; of those beyond the margin none shows below it."""
    time, angle, _ = run_up(20.0, 40.0)
    low, high = (output(np.sin(TURN * f * time), time) for f in (1000.0, 4000.0))
    shaft = output(angle, time, "angle", "sun")
    found = find_order_spectrum(low, shaft)
    assert found.axis[-1] == pytest.approx(0.4 * 8192.0 / 40.0, rel=1e-3)
    inside = (found.axis > 24.0) & (found.axis < 51.0)
    assert found.value[~inside].max() < 0.02 * found.value.max()
    assert find_order_spectrum(high, shaft).value[:2500].max() < 1e-2 * found.value.max()


def test_interpolation_is_true_up_to_the_margin():
    time, angle, _ = run_up(32.0, 32.0)
    shaft = output(angle, time, "angle", "sun")
    for order, error in ((25.0, 1e-5), (64.0, 2e-3), (102.0, 0.09)):
        found = find_order_spectrum(output(np.sin(order * angle), time), shaft)
        assert found.value.max() == pytest.approx(1.0, rel=error)


def test_a_shaft_may_turn_the_other_way():
    time, angle, _ = run_up(5.0, 40.0)
    found = find_order_spectrum(output(np.sin(7.0 * angle), time), output(-angle, time, "angle", "sun"))
    assert found.axis[int(np.argmax(found.value))] == pytest.approx(7.0, abs=1e-9)


@pytest.mark.parametrize(
    ("first", "last", "message"),
    [(-5.0, 40.0, "stands, turns back"), (0.0, 40.0, "very slow"), (0.5, 1.4, "turns 1.9 times in the span, 4")],
)
def test_shafts_that_cannot_serve_are_refused(first, last, message):
    time, angle, _ = run_up(first, last)
    with pytest.raises(LtcgearError, match=message):
        find_order_spectrum(output(angle, time), output(angle, time, "angle", "sun"))
