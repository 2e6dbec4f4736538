import numpy as np
import pytest
from ltcgear.runtime.spectra import (
    Line,
    amplitude_spectrum,
    name_line,
    planar_spectrum,
    strongest_lines,
)

RATE = 1000.0
TIME = np.arange(1000) / RATE
MESHES = {"lsp": 29.5, "hsp": 158.2, "psh": 628.3}


def sine(amplitude, frequency, phase=0.3):
    return amplitude * np.sin(2 * np.pi * frequency * TIME + phase)


def test_a_sine_on_a_bin_reads_its_amplitude():
    frequency, amplitude = amplitude_spectrum(sine(3.0, 50.0), RATE)
    assert frequency[1] == 1.0
    assert frequency[-1] == 500.0
    assert np.argmax(amplitude) == 50
    assert amplitude[50] == pytest.approx(3.0, rel=1e-12)
    # Hann's main lobe: half the amplitude in the neighbours, nothing beyond.
    assert amplitude[[49, 51]] == pytest.approx(1.5, rel=1e-12)
    assert np.delete(amplitude, [49, 50, 51]).max() < 1e-12


def test_the_mean_is_bin_zero_and_does_not_leak():
    _, amplitude = amplitude_spectrum(-7.0 + sine(0.5, 100.0), RATE)
    assert amplitude[0] == pytest.approx(7.0)
    assert amplitude[1] < 1e-12
    assert amplitude[100] == pytest.approx(0.5)


def test_half_way_between_bins_a_sine_reads_fifteen_percent_low():
    _, amplitude = amplitude_spectrum(sine(1.0, 200.5), RATE)
    assert amplitude[200] == pytest.approx(8.0 / (3.0 * np.pi), rel=1e-3)


def test_the_nyquist_bin_is_not_doubled():
    _, amplitude = amplitude_spectrum(2.0 * (-1.0) ** np.arange(1000), RATE)
    assert amplitude[-1] == pytest.approx(2.0)


def test_an_odd_number_of_samples():
    frequency, amplitude = amplitude_spectrum(4.0 * np.cos(2 * np.pi * 11 * np.arange(101) / 101), 101.0)
    assert frequency.size == amplitude.size == 51
    assert amplitude[11] == pytest.approx(4.0)


@pytest.mark.parametrize("signal", [np.ones((4, 2)), np.ones(3)])
def test_what_is_no_signal_is_refused(signal):
    with pytest.raises(ValueError, match="at least 4 samples"):
        amplitude_spectrum(signal, RATE)


def test_two_axes_add_as_root_sum_square():
    frequency, amplitude = planar_spectrum(sine(3.0, 60.0, 0.0), sine(4.0, 60.0, 1.0), RATE)
    assert frequency[60] == 60.0
    assert amplitude[60] == pytest.approx(5.0)


def test_lines_come_strongest_first():
    spectrum = amplitude_spectrum(sine(1.0, 50.0) + sine(3.0, 120.0) + sine(2.0, 300.0), RATE)
    lines = strongest_lines(*spectrum, count=2, separation_hz=5.0)
    assert [line.frequency_hz for line in lines] == [120.0, 300.0]
    assert [line.amplitude for line in lines] == pytest.approx([3.0, 2.0])
    assert isinstance(lines[0], Line)


def test_of_close_lines_the_stronger_stays():
    spectrum = amplitude_spectrum(sine(1.0, 100.0) + sine(2.0, 106.0), RATE)
    assert [line.frequency_hz for line in strongest_lines(*spectrum, 5, 10.0)] == [106.0]
    assert [line.frequency_hz for line in strongest_lines(*spectrum, 5, 3.0)] == [106.0, 100.0]


def test_dust_is_no_line():
    spectrum = amplitude_spectrum(sine(1.0, 100.0) + sine(1e-4, 200.0), RATE)
    assert len(strongest_lines(*spectrum, 5, 3.0)) == 1
    assert len(strongest_lines(*spectrum, 5, 3.0, relative_floor=1e-5)) == 2


def test_silence_has_no_lines():
    assert strongest_lines(*amplitude_spectrum(np.zeros(1000), RATE), 5, 3.0) == []


@pytest.mark.parametrize(
    ("frequency", "name"),
    [
        (29.5, "1 x lsp"),
        (59.2, "2 x lsp"),
        (474.4, "3 x hsp"),
        (628.1, "1 x psh"),
        (187.7, "hsp + 1 x lsp"),
        (99.3, "hsp - 2 x lsp"),
        (345.9, "2 x hsp + 1 x lsp"),
        (786.5, "psh + 1 x hsp"),
        (45.0, ""),
        (557.5, ""),
    ],
)
def test_names(frequency, name):
    assert name_line(frequency, MESHES, 0.5) == name


def test_a_low_order_beats_a_closer_high_one():
    assert name_line(300.0, {"a": 30.0, "b": 150.2}, 0.5) == "2 x b"


def test_standing_meshes_explain_nothing():
    assert name_line(0.1, {"lsp": 0.0, "hsp": 50.0}, 0.5) == ""
