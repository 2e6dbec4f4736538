"""Envelopes and sidebands of modulated signals."""

import numpy as np
import pytest
from ltcgear.generated.errors import LtcgearError
from ltcgear.runtime.analysis import (
    find_envelope,
    find_sidebands,
    find_spectrum,
    name_lines,
)
from ltcgear.runtime.analysis.envelope import choose_band
from ltcgear.runtime.analysis.lines import Clues

from ..outputs import output, times

TIME = times()
TURN = 2 * np.pi


def pulses(turns=24.5, share=0.03, size=1.0):
    """A blow once a turn, as a tooth that is out of place strikes."""
    beat = (turns * TIME) % 1.0
    return size * np.exp(-0.5 * ((beat - 0.5) / share) ** 2)


def test_the_envelope_of_blows_peaks_at_the_shafts_turns():
    ringing = 5.0 * np.sin(TURN * 490.0 * TIME) * (1.0 + pulses(share=0.1))
    found = find_envelope(output(ringing, TIME), *choose_band(find_spectrum(output(ringing, TIME)), 490.0))
    lines = name_lines(found.spectrum, Clues({"gear": 490.0}, {}, {"gear.input": 24.5}), 4)
    assert lines[0].name == "1 gear.input"
    assert {line.name for line in lines} == {f"{k} gear.input" for k in range(1, 5)}


def modulated(depth=0.3, carrier=600.0, beat=20.0):
    return output(4.0 * (1.0 + depth * np.cos(TURN * beat * TIME)) * np.sin(TURN * carrier * TIME), TIME)


def test_an_amplitude_modulation_has_its_envelope_and_sidebands():
    signal = modulated()
    found = find_envelope(signal, 500.0, 700.0)
    assert found.value == pytest.approx(4.0 * (1.0 + 0.3 * np.cos(TURN * 20.0 * TIME)), rel=1e-9)
    assert found.spectrum.value[0] == pytest.approx(4.0)
    assert found.spectrum.value[20] == pytest.approx(1.2)
    bands = find_sidebands(find_spectrum(signal), ("1 psh", 600.0), ("shaft", 20.0))
    assert bands.amplitude == pytest.approx(4.0)
    assert bands.lower == pytest.approx((0.6, 0.0, 0.0), abs=1e-9)
    assert bands.upper == pytest.approx((0.6, 0.0, 0.0), abs=1e-9)
    assert bands.depth == pytest.approx(0.3)


def test_what_lies_outside_the_band_does_not_count():
    other = modulated() + output(9.0 * np.sin(TURN * 1500.0 * TIME) + 5.0, TIME)
    assert find_envelope(other, 500.0, 700.0).value == pytest.approx(find_envelope(modulated(), 500.0, 700.0).value)


def test_leakage_is_no_sideband():
    """A line between bins has skirts; what they are at the turns of a shaft is no modulation."""
    alone = output(np.sin(TURN * 600.37 * TIME) + 1e-3 * np.sin(TURN * 20.0 * TIME), TIME)
    for window in ("hann", "boxcar"):
        bands = find_sidebands(find_spectrum(alone, window=window), ("1 psh", 600.37), ("shaft", 20.3))
        assert (bands.lower, bands.upper, bands.depth) == (3 * (0.0,), 3 * (0.0,), 0.0)
    noise = 1e-2 * np.random.default_rng(3).normal(size=TIME.size)
    assert find_sidebands(find_spectrum(modulated(1e-4) + noise), ("1 psh", 600.0), ("shaft", 20.0)).depth == 0.0
    weak = find_sidebands(find_spectrum(modulated(0.02, 600.37) + noise), ("1 psh", 600.37), ("shaft", 20.0))
    assert weak.depth == pytest.approx(0.02, rel=0.1)


def test_sidebands_three_bins_from_the_line_are_read():
    bands = find_sidebands(find_spectrum(modulated(beat=3.0)), ("1 psh", 600.0), ("shaft", 3.0))
    assert bands.lower == pytest.approx((0.6, 0.0, 0.0), abs=1e-9)


def test_sidebands_too_close_to_tell_are_none():
    assert find_sidebands(find_spectrum(modulated()), ("1 psh", 600.0), ("carrier", 1.3)) is None


def test_the_band_is_about_the_strongest_harmonic():
    signal = output(np.sin(TURN * 200.0 * TIME) + 3.0 * np.sin(TURN * 400.0 * TIME), TIME)
    assert choose_band(find_spectrum(signal), 200.0) == (300.0, 500.0)


@pytest.mark.parametrize("band", [(0.0, 100.0), (200.0, 100.0), (100.0, 5000.0), (100.2, 100.8)])
def test_bands_that_cannot_be_are_refused(band):
    with pytest.raises(LtcgearError, match="--band"):
        find_envelope(modulated(), *band)
