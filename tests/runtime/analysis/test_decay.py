"""Lines that die away as a mode does."""

import numpy as np
import pytest
from ltcgear.runtime.analysis import (
    find_spectrum,
    name_lines,
)
from ltcgear.runtime.analysis.decay import decays_as
from ltcgear.runtime.analysis.lines import Clues
from ltcgear.runtime.linear.modes import Mode

from ..outputs import output, times

TIME = times()
TURN = 2 * np.pi


def mode(frequency_hz, damping_ratio=0.01, kind="torsional", name="a against b"):
    none = np.zeros(0, dtype=complex)
    return Mode(frequency_hz, damping_ratio, kind, {}, 1j, none, none, 0, {}, name=name)


FREQUENCY, DECAY = 391.3, 2.5
"""A mode whose vibration falls to a twelfth in the second that `TIME` lasts."""
RINGING = {"mode 9": (FREQUENCY, DECAY / TURN)}


def named(values, start=0.0, stop=1.0, modes=None, window="hann"):
    """The first line of a signal, its start and stop chosen, with the modes at hand."""
    signal = output(values, TIME).sel(time=slice(start, stop))
    clues = Clues(modes=RINGING if modes is None else modes)
    return name_lines(find_spectrum(signal, window=window), clues, 1, signals=(signal,))[0]


@pytest.mark.parametrize("window", ["hann", "flattop"])
def test_a_line_that_dies_away_as_its_mode_does_is_free_vibration(window):
    found = named(np.exp(-DECAY * TIME) * np.sin(TURN * FREQUENCY * TIME), window=window)
    assert (found.kind, found.name, found.mode) == ("mode", "mode 9", "mode 9")


@pytest.mark.parametrize(
    ("values", "why"),
    [
        (np.sin(TURN * FREQUENCY * TIME), "steady"),
        (np.exp(-2.0 * DECAY * TIME) * np.sin(TURN * FREQUENCY * TIME), "too quick"),
        (np.exp(-0.5 * DECAY * TIME) * np.sin(TURN * FREQUENCY * TIME), "too slow"),
        (np.exp(DECAY * TIME) * np.sin(TURN * FREQUENCY * TIME), "grows"),
        ((1.0 - TIME) * np.sin(TURN * FREQUENCY * TIME), "no exponential"),
        (np.random.default_rng(5).normal(size=TIME.size), "noise"),
    ],
)
def test_what_is_merely_near_an_eigenfrequency_is_no_mode(values, why):
    found = named(values, modes={"mode 9": (FREQUENCY, 4000.0)} if why == "noise" else None)
    assert (found.kind, found.name, found.mode) == ("", "", "mode 9"), why


def test_in_a_span_in_which_a_mode_hardly_decays_it_is_not_shown():
    """A quarter of a second: exp(-0.6) is more than a half."""
    values = np.exp(-DECAY * TIME) * np.sin(TURN * FREQUENCY * TIME)
    assert named(values, stop=0.24).name == ""
    assert named(values, stop=0.32).name == "mode 9"


def test_a_harmonic_keeps_its_name_whatever_dies_away():
    signal = output(np.exp(-DECAY * TIME) * np.sin(TURN * FREQUENCY * TIME), TIME)
    clues = Clues({"a": FREQUENCY / 3.0}, modes=RINGING)
    found = name_lines(find_spectrum(signal), clues, 1, signals=(signal,))[0]
    assert (found.name, found.mode) == ("3 a", "mode 9")


def test_two_axes_decay_together():
    x, y = (output(np.exp(-DECAY * TIME) * wave(TURN * FREQUENCY * TIME), TIME) for wave in (np.sin, np.cos))
    assert decays_as((x, y), FREQUENCY, DECAY)
    assert not decays_as((), FREQUENCY, DECAY)
    assert not decays_as((x * 0.0,), FREQUENCY, DECAY)
