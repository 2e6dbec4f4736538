"""The band's filter against closed forms: tones, square waves, steps; ends, phase, and what it leaves of a rate."""

import numpy as np
import pytest
from ltcgear.runtime.results.amplitude_spectrum import amplitude_spectrum, strongest_lines
from ltcgear.runtime.simulation.low_pass import ATTENUATION, BAND, FINE, REACH, BandFilter, filter_table, response
from ltcgear.runtime.simulation.quadrature import FILTERED, MOST, MOTION, lobatto_rules
from scipy.signal import firwin, freqz, kaiser_beta

RATE = 8192.0


def points_of(borders, count=16):
    """Gauss's points and weights of each piece between borders."""
    at, weight = np.polynomial.legendre.leggauss(count)
    length = np.diff(borders)
    time = borders[:-1, None] + (1 + at) / 2 * length[:, None]
    return time.ravel(), (weight / 2 * length[:, None]).ravel()


def filtered(signal, borders, end, chunks=1):
    """Rows of the filter for a signal that is smooth between borders, handed over in some chunks."""
    time, weight = points_of(borders)
    start = signal(np.zeros(1))[0]
    made, rows = BandFilter(RATE, start), []
    for part in np.array_split(np.arange(len(time)), chunks):
        made.take(time[part], weight[part], signal(time[part]) - start)
        rows.append(made.release())
    last = round(end * RATE)
    return np.concatenate([*rows, made.finish(last, signal(np.array([last / RATE]))[0] - start)])


def tone(frequency, phase=0.4):
    return lambda time: np.cos(2 * np.pi * frequency * time + phase)[:, None]


def square(frequency):
    """A square wave with jumps at whole and half cycles, as stiffness jumps make it."""
    return lambda time: np.where(np.mod(frequency * time + 0.1234, 1.0) < 0.5, 1.0, -1.0)[:, None]


def borders_of(frequency, end):
    cycles = np.arange(1, int(2 * frequency * end) + 2) / 2 - 0.1234
    inner = cycles / frequency
    return np.concatenate([[0.0], inner[(inner > 0) & (inner < end)], [end]])


def read_peaks(values, floor=0.003):
    spectrum = amplitude_spectrum(values, RATE)
    return {line.frequency_hz: line.amplitude for line in strongest_lines(*spectrum, 1000, 3.0, floor)}


def test_the_response_is_that_of_scipys_kaiser_filter():
    length = 2 * REACH * FINE + 1
    made = firwin(length, 1.0 / FINE, window=("kaiser", kaiser_beta(ATTENUATION)))
    places = np.linspace(0.0, 1.0, 101)
    _, wanted = freqz(made, worN=2 * np.pi * places / FINE)
    assert np.abs(np.abs(response(places * RATE, RATE)) - np.abs(wanted)).max() < 1e-6
    assert filter_table().shape == (FINE + 1, 2 * REACH)


def test_the_band_is_kept_and_what_could_fold_into_it_is_not():
    assert np.abs(response(np.linspace(0, BAND, 500) * RATE, RATE) - 1).max() < 8e-4
    assert np.abs(response(np.linspace(1 - BAND, 5, 2000) * RATE, RATE)).max() < 8e-4


@pytest.mark.parametrize("frequency", [100.0, 1500.0, BAND * RATE])
def test_a_tone_in_the_band_keeps_amplitude_and_phase(frequency):
    rows = filtered(tone(frequency), np.linspace(0, 0.1, 1500), 0.1)[:, 0]
    true = tone(frequency)(np.arange(len(rows)) / RATE)[:, 0]
    assert np.abs(rows - true)[REACH:-REACH].max() < 1e-3


@pytest.mark.parametrize("frequency", [(1 - BAND) * RATE, 7969.0, 20000.0])
def test_a_tone_that_would_fold_into_the_band_is_gone(frequency):
    rows = filtered(tone(frequency), np.linspace(0, 0.1, 6000), 0.1)[:, 0]
    assert np.abs(rows)[REACH:-REACH].max() < 1e-3


def test_a_square_wave_has_its_harmonics_and_no_false_line():
    # Odd harmonics 4 / (pi k) without end; sampled as it is, the 13th shows at 8192 - 13 * 613 Hz = 223 Hz.
    borders = borders_of(613.0, 1.0)
    rows = filtered(square(613.0), borders, 1.0)[:-1, 0]
    naive = read_peaks(square(613.0)(np.arange(8192) / RATE)[:, 0])
    assert naive[223.0] == pytest.approx(4 / (13 * np.pi), rel=0.05)
    wanted = {613.0 * k: 4 / (np.pi * k) for k in (1, 3, 5)}
    assert {f: a for f, a in read_peaks(rows).items() if f < 3300} == pytest.approx(wanted, rel=1e-3)


def test_ends_are_those_of_the_motion_and_a_ramp_stays_a_ramp():
    rows = filtered(
        lambda time: np.stack([3.0 + 7.0 * time, np.cos(900.0 * time)], 1), np.linspace(0, 410 / RATE, 400), 410 / RATE
    )
    time = np.arange(len(rows)) / RATE
    assert np.abs(rows[:, 0] - 3.0 - 7.0 * time).max() < 1e-6
    assert rows[0, 1] == 1.0
    assert rows[-1, 1] == pytest.approx(np.cos(900.0 * time[-1]), rel=1e-14)
    assert np.abs(rows[:, 1] - np.cos(900.0 * time)).max() < 0.02  # its image bends the other way at the start


def test_what_stands_still_is_kept_to_the_last_bit():
    rows = filtered(lambda time: np.full((len(time), 1), 357_496.123), borders_of(613.0, 0.05), 0.05)
    assert (rows == 357_496.123).all()


def test_no_row_depends_on_how_points_come():
    borders = borders_of(613.0, 0.05)
    whole = filtered(square(613.0), borders, 0.05)
    for chunks in (2, 17, 200):
        assert (filtered(square(613.0), borders, 0.05, chunks) == whole).all()


def test_a_record_shorter_than_the_filter_has_rows_all_the_same():
    rows = filtered(square(613.0), borders_of(613.0, 5 / RATE), 5 / RATE)
    assert rows.shape == (6, 1)
    assert np.isfinite(rows).all()


@pytest.mark.parametrize("kind", ["motion", "filtered"])
def test_rules_resolve_what_they_say(kind):
    rules, most = lobatto_rules(), {"motion": MOTION, "filtered": FILTERED}[kind]
    reach = getattr(rules, kind)
    assert (np.diff(reach) > 0).all()
    for count in range(2, MOST + 1):
        at, weight = (array[count * (count - 1) // 2 - 1 :][:count] for array in (rules.at, rules.weight))
        assert (at[0], at[-1]) == (0.0, 1.0)
        for degree in range(2 * count - 2):
            assert weight @ at**degree == pytest.approx(1 / (degree + 1), rel=1e-12)
        for angle, holds in ((0.98 * reach[count - 2], True), (1.02 * reach[count - 2] + 0.002, False)):
            error = abs(np.sum(weight * np.cos(2 * angle * (at - 0.5))) - np.sinc(angle / np.pi))
            assert (error < most) == holds
