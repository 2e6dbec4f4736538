"""Amplitude spectra and densities of signals whose lines are known."""

import numpy as np
import pytest
from ltcgear.generated.errors import LtcgearError
from ltcgear.runtime.analysis import (
    find_density,
    find_spectrum,
    select_output,
)
from ltcgear.runtime.results.amplitude_spectrum import WINDOWS, noise_bandwidth

from ..outputs import output, times
from ..synthetic import make_dataset

TIME = times()
TURN = 2 * np.pi


@pytest.mark.parametrize("window", WINDOWS)
def test_a_sine_reads_its_amplitude_under_every_window(window):
    found = find_spectrum(output(5.0 + 3.0 * np.sin(TURN * 200.0 * TIME + 0.4), TIME), window=window)
    assert found.value[0] == pytest.approx(5.0)
    assert found.value[200] == pytest.approx(3.0, rel=1e-9)
    assert (found.unit, found.axis_unit, found.resolution) == ("N", "Hz", pytest.approx(1.0))
    # Outside of its main lobe a sine on a bin leaves nothing.
    lobe = WINDOWS[window]
    outside = np.delete(found.value[1:], np.arange(200 - lobe, 200 + lobe - 1))
    assert outside.max() < 2e-4 * 3.0
    assert found.separation == pytest.approx(lobe * found.resolution)


@pytest.mark.parametrize(("window", "reads"), [("hann", 0.849), ("flattop", 1.0), ("boxcar", 2 / np.pi)])
def test_half_way_between_bins(window, reads):
    """Scallop loss: Hann 1.42 dB, rectangular 3.92 dB (Harris 1978, table 1); a flat top has none."""
    found = find_spectrum(output(np.sin(TURN * 200.5 * TIME), TIME), window=window)
    assert found.value.max() == pytest.approx(reads, rel=2e-3)


def test_noise_bandwidths_are_those_of_harris():
    """Harris 1978, table 1: rectangular 1.00, Hann 1.50, minimum 4-term Blackman-Harris 2.00 bins."""
    found = {window: noise_bandwidth(window, 4096) for window in WINDOWS}
    assert found["boxcar"] == pytest.approx(1.0)
    assert found["hann"] == pytest.approx(1.5)
    assert found["blackmanharris"] == pytest.approx(2.0, abs=0.01)
    assert find_spectrum(output(TIME, TIME)).bandwidth == pytest.approx(1.5 * 1.0)


def test_two_axes_add_as_root_sum_square():
    x, y = (output(a * np.sin(TURN * 60.0 * TIME + p), TIME, "displacement_x") for a, p in ((3.0, 0.0), (4.0, 1.0)))
    found = find_spectrum(x, y)
    assert found.value[60] == pytest.approx(5.0)
    assert found.name == "displacement:psh.mesh"


@pytest.mark.parametrize("window", WINDOWS)
def test_a_density_holds_the_variance(window):
    """Parseval: the integral of the density is the variance, exactly for whole sines in one segment."""
    signal = 7.0 + 2.0 * np.sin(TURN * 64.0 * TIME) + np.sin(TURN * 500.0 * TIME)
    found = find_density(output(signal, TIME), window=window, segment_s=1.0)
    assert found.value.sum() * found.resolution == pytest.approx(2.5, rel=1e-6)
    assert found.unit == "N^2/Hz"
    assert found.averaged == 1


def test_the_density_of_white_noise_is_flat():
    noise = np.random.default_rng(1).normal(0.0, 3.0, TIME.size * 8)
    time = times(8.0)
    found = find_density(output(noise, time), segment_s=0.125)
    assert found.averaged == 127
    assert found.value[2:-2].mean() == pytest.approx(9.0 / 4096.0, rel=0.02)
    assert found.value[2:-2].std() < 0.15 * found.value.mean()


@pytest.mark.parametrize("segment", [1e-3, 2.0])
def test_segments_that_cannot_serve_are_refused(segment):
    with pytest.raises(LtcgearError, match=r"segments of .* give 0\.007813 to 1 s"):
        find_density(output(TIME, TIME), segment_s=segment)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        (np.where(TIME < 0.5, 1.0, np.nan), "mesh_force:psh.mesh: not a number from 0.5 s on"),
        (np.ones((TIME.size, 2)), "choose one item over time"),
    ],
)
def test_what_is_no_signal_is_refused(values, message):
    signal = output(TIME, TIME)
    signal = signal.expand_dims(mesh=["a", "b"], axis=1) if values.ndim == 2 else signal.copy(data=values)
    with pytest.raises(LtcgearError, match=message):
        find_spectrum(signal)


def test_too_few_samples_and_unknown_windows_are_refused():
    with pytest.raises(LtcgearError, match="63 samples are too few, 64 at least"):
        find_spectrum(output(TIME[:63], TIME[:63]))
    with pytest.raises(LtcgearError, match="window hamming: must be one of hann, flattop, blackmanharris, boxcar"):
        find_spectrum(output(TIME, TIME), window="hamming")


def test_outputs_are_found_by_name():
    dataset = make_dataset()
    (force,) = select_output(dataset, "mesh_force:psh.mesh")
    assert force.dims == ("time",)
    assert len(select_output(dataset, "acceleration:lsp.sun")) == 2
    with pytest.raises(LtcgearError, match=r"mesh_forces:psh.mesh: no such quantity; .*did you mean \"mesh_force\""):
        select_output(dataset, "mesh_forces:psh.mesh")
    with pytest.raises(LtcgearError, match=r"psh.mech: mesh_force has no such item; did you mean \"psh.mesh\""):
        select_output(dataset, "mesh_force:psh.mech")
