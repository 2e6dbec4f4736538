import numpy as np
import pytest
from ltcgear.runtime.results.amplitude_spectrum import (
    Line,
    Sources,
    amplitude_spectrum,
    find_peaks,
    name_line,
    planar_spectrum,
    strongest_lines,
    window_samples,
)

RATE = 1000.0
TIME = np.arange(1000) / RATE
MESHES = {"lsp": 29.5, "hsp": 158.2, "psh": 628.3}
STAGES = {"hsp.carrier": "hsp"}
CARRIER = {"lsp.carrier": 0.0, "hsp.carrier": 1.34}


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


COSINES = {"hann": (0.5, 0.5), "blackmanharris": (0.35875, 0.48829, 0.14128, 0.01168), "boxcar": (1.0,)}
"""a of w_n = a_0 - a_1 cos(2 pi n / N) + a_2 cos(4 pi n / N) - ... (Harris 1978, Proc. IEEE 66:51)."""


@pytest.mark.parametrize("window", COSINES)
@pytest.mark.parametrize("count", [64, 101])
def test_windows_are_the_printed_ones_and_periodic(window, count):
    angle = 2.0 * np.pi / count * np.arange(count)
    printed = sum((-1) ** k * share * np.cos(k * angle) for k, share in enumerate(COSINES[window]))
    assert window_samples(window, count) == pytest.approx(printed, abs=1e-12)


def test_under_a_flat_top_a_sine_between_bins_reads_its_amplitude():
    _, amplitude = amplitude_spectrum(sine(1.0, 200.5), RATE, "flattop")
    assert amplitude[200] == pytest.approx(1.0, abs=2e-3)


@pytest.mark.parametrize(("distance", "found"), [(1, [4, 7, 1]), (3, [4, 7, 1]), (4, [4])])
def test_peaks_come_largest_first_flat_ones_by_their_middles(distance, found):
    assert find_peaks(np.array([0.0, 1.0, 1.0, 0.0, 3.0, 0.0, 2.0, 2.0, 2.0, 1.0]), distance) == found


def test_values_of_one_level_have_no_peaks():
    assert find_peaks(np.ones(5)) == find_peaks(np.ones(1)) == find_peaks(np.array([1.0, 2.0])) == []


def test_silence_has_no_lines():
    assert strongest_lines(*amplitude_spectrum(np.zeros(1000), RATE), 5, 3.0) == []


@pytest.mark.parametrize(
    ("frequency", "name"),
    [
        (29.5, "1 lsp"),
        (59.2, "2 lsp"),
        (474.4, "3 hsp"),
        (628.1, "1 psh"),
        (187.7, "hsp + 1 lsp"),
        (99.3, "hsp - 2 lsp"),
        (345.9, "2 hsp + 1 lsp"),
        (786.5, "psh + 1 hsp"),
        (413.0, "14 lsp"),
        (737.5, "25 lsp"),
        (767.0, ""),  # would be 26 lsp
        (1098.4, "2 psh - 1 hsp"),
        (156.9, ""),
        (45.0, ""),
        (557.5, ""),
    ],
)
def test_names(frequency, name):
    assert name_line(frequency, Sources(MESHES), 0.5) == name


@pytest.mark.parametrize(
    ("frequency", "name"),
    [
        (156.86, "hsp - 1 hsp.carrier"),
        (159.54, "hsp + 1 hsp.carrier"),
        (313.72, "2 hsp - 2 hsp.carrier"),
        (624.28, ""),
        (158.2, "1 hsp"),
        (158.6, "1 hsp"),  # 0.4 Hz from the harmonic
        (187.7, "hsp + 1 lsp"),
        (152.84, ""),  # four turns are one too many
        (45.0, ""),
    ],
)
def test_names_by_a_carriers_turns(frequency, name):
    assert name_line(frequency, Sources(MESHES, CARRIER, stages=STAGES), 0.5) == name


def test_without_rotations_a_carriers_turns_explain_nothing():
    assert [name_line(frequency, Sources(MESHES), 0.5) for frequency in (156.86, 159.54, 313.72, 624.28)] == [""] * 4
    assert name_line(156.86, Sources(MESHES, {"hsp.carrier": 0.0}, stages=STAGES), 0.5) == ""


def test_of_sidebands_of_meshes_and_carriers_the_lowest_sum_of_orders_wins():
    # 628.3 - 158.2 = 470.1 Hz exactly; 3 * 158.2 - 3 * 1.34 = 470.58 Hz is 0.48 Hz away and of order 6.
    assert name_line(470.1, Sources(MESHES), 0.5) == "psh - 1 hsp"
    assert name_line(470.1, Sources(MESHES, CARRIER, stages=STAGES), 0.5) == "psh - 1 hsp"


def test_a_low_order_beats_a_closer_high_one():
    assert name_line(300.0, Sources({"a": 30.0, "b": 150.2}), 0.5) == "2 b"
    assert name_line(480.0, Sources({"a": 20.0}), 0.5) == "24 a"
    assert name_line(520.0, Sources({"a": 20.0}), 0.5) == ""


def test_standing_meshes_explain_nothing():
    assert name_line(0.1, Sources({"lsp": 0.0, "hsp": 50.0}), 0.5) == ""
