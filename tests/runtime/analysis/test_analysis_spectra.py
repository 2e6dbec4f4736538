"""Spectra, orders, waterfalls and envelopes of signals whose lines are known."""

from dataclasses import replace

import numpy as np
import pytest
from ltcgear.generated.errors import LtcgearError
from ltcgear.runtime.analysis import (
    find_clues,
    find_density,
    find_envelope,
    find_order_spectrum,
    find_sidebands,
    find_spectrum,
    find_waterfall,
    mesh_courses,
    name_lines,
    select_output,
)
from ltcgear.runtime.analysis.decay import decays_as
from ltcgear.runtime.analysis.envelope import choose_band
from ltcgear.runtime.analysis.lines import Clues
from ltcgear.runtime.analysis.order_spectrum import choose_shaft
from ltcgear.runtime.linear.modes import Mode
from ltcgear.runtime.results.amplitude_spectrum import WINDOWS, Sources, explain_line, noise_bandwidth

from ..outputs import output, result, times
from ..synthetic import FREE, HSP, LSP, PSH, STEADY, make_dataset

TIME = times()
TURN = 2 * np.pi


# --- amplitudes


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


# --- names


def mode(frequency_hz, damping_ratio=0.01, kind="torsional", name="a against b"):
    none = np.zeros(0, dtype=complex)
    return Mode(frequency_hz, damping_ratio, kind, {}, 1j, none, none, 0, {}, name=name)


def test_the_lines_of_a_result_are_named():
    part = make_dataset().sel(time=slice(STEADY, None))
    modes = [mode(0.0, 0.0, "rigid"), mode(FREE + 0.2), mode(2 * HSP + 1.0)]
    clues = find_clues(part, modes)
    assert clues.meshes == pytest.approx({"lsp": LSP, "hsp": HSP, "psh": PSH})
    assert list(clues.modes) == ["mode 2", "mode 3"]
    found = name_lines(find_spectrum(*select_output(part, "acceleration:lsp.planet.1")), clues)
    assert [(line.place, line.kind, line.name, line.mode) for line in found] == [
        (pytest.approx(2 * HSP), "harmonic", "2 hsp", "mode 3"),
        (pytest.approx(LSP), "harmonic", "1 lsp", ""),
        (pytest.approx(FREE), "", "", "mode 2"),  # it does not die away, so it is not shown to be free
    ]
    assert found[0].amplitude == pytest.approx(1.3)
    sun = name_lines(find_spectrum(*select_output(part, "acceleration:hsp.sun")), clues)
    assert [line.name for line in sun] == ["1 psh", "hsp - 1 hsp.carrier"]


def test_without_clues_lines_have_no_names():
    found = name_lines(find_spectrum(output(np.sin(TURN * 100.0 * TIME), TIME)), Clues())
    assert [(line.place, line.kind, line.name) for line in found] == [(pytest.approx(100.0), "", "")]


@pytest.mark.parametrize(
    ("frequency", "kind", "name"),
    [
        (158.2, "harmonic", "1 hsp"),
        (187.7, "sideband", "hsp + 1 lsp"),
        (156.86, "sideband", "hsp - 1 hsp.carrier"),
        (2.68, "shaft", "2 hsp.carrier"),
        (10.6, "shaft", "1 hsp.sun"),
        (10.45, "", ""),  # slow turns explain what is within a third of the tolerance
        (628.3 - 29.9, "shaft", "psh - 1 psh.output"),
        (391.0, "", ""),
        (46 * 29.5 + 0.05, "harmonic", "46 lsp"),
        (46 * 29.5 + 0.2, "", ""),
        (4 * 628.3, "harmonic", "4 psh"),
        (9 * 628.3 - 158.2, "sideband", "9 psh - 1 hsp"),
        (11 * 628.3 + 2 * 29.9, "", ""),
        (13 * 29.9, "", ""),
    ],
)
def test_explanations_in_turn(frequency, kind, name):
    meshes, carriers = {"lsp": 29.5, "hsp": 158.2, "psh": 628.3}, {"hsp.carrier": 1.34}
    shafts, stages = (
        {"hsp.sun": 10.6, "psh.output": 29.9},
        {"hsp.carrier": "hsp", "hsp.sun": "hsp", "psh.output": "psh"},
    )
    assert explain_line(frequency, Sources(meshes, carriers, shafts, stages=stages), 0.3, 6000.0) == (kind, name)


@pytest.mark.parametrize(
    ("order", "kind", "name"),
    [
        (1, "shaft", "1 gear.input"), (2, "shaft", "2 gear.input"), (13, "shaft", "13 gear.input"),
        (19, "shaft", "gear - 1 gear.input"), (20, "harmonic", "1 gear"), (23, "shaft", "gear + 3 gear.input"),
        (27, "shaft", "27 gear.input"), (161, "shaft", "8 gear + 1 gear.input"), (169, "shaft", "169 gear.input"),
    ],
)  # fmt: skip
def test_every_order_of_a_shaft_with_a_fault_is_named(order, kind, name):
    """Twenty teeth: each whole order is a harmonic, a sideband of three steps at most, or so many turns."""
    comb = {"gear.input": 24.5}
    assert explain_line(
        24.5 * order, Sources({"gear": 490.0}, {}, comb, comb, {"gear.input": "gear"}), 0.6, 4200.0
    ) == (kind, name)


def pulses(turns=24.5, share=0.03, size=1.0):
    """A blow once a turn, as a tooth that is out of place strikes."""
    beat = (turns * TIME) % 1.0
    return size * np.exp(-0.5 * ((beat - 0.5) / share) ** 2)


def test_a_blow_once_a_turn_has_the_orders_of_its_shaft_and_no_other():
    """Without a comb at its own neighbours a slower shaft, whose 25th order is 9 orders of this one, names nothing."""
    meshes, shafts = {"gear": 20 * 24.5}, {"gear.input": 24.5, "gear.output": 24.5 * 9 / 25}
    signal = output(pulses() + 0.3 * np.sin(TURN * 490.0 * TIME), TIME)
    found = name_lines(find_spectrum(signal), Clues(meshes, {}, shafts), 14)
    names = {round(line.place / 24.5): line.name for line in found}
    assert names == {k: f"{k} gear.input" for k in range(1, 14)} | {20: "1 gear"}
    lone = output(np.sin(TURN * 9 * 24.5 * TIME), TIME)
    assert name_lines(find_spectrum(lone), Clues(meshes, {}, shafts), 1)[0].name == ""


def test_the_envelope_of_blows_peaks_at_the_shafts_turns():
    ringing = 5.0 * np.sin(TURN * 490.0 * TIME) * (1.0 + pulses(share=0.1))
    found = find_envelope(output(ringing, TIME), *choose_band(find_spectrum(output(ringing, TIME)), 490.0))
    lines = name_lines(found.spectrum, Clues({"gear": 490.0}, {}, {"gear.input": 24.5}), 4)
    assert lines[0].name == "1 gear.input"
    assert {line.name for line in lines} == {f"{k} gear.input" for k in range(1, 5)}


# --- free vibration


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


# --- places and ends


@pytest.mark.parametrize(
    ("window", "error"), [("hann", 0.02), ("flattop", 0.15), ("blackmanharris", 0.01), ("boxcar", 0.17)]
)
def test_lines_between_bins_are_placed_there(window, error):
    """A sine anywhere between bins, under each window within less than the fifth of a bin by which names go."""
    for place in (400.0, 400.1, 400.25, 400.4, 400.5, 400.77):
        found = name_lines(find_spectrum(output(np.sin(TURN * place * TIME), TIME), window=window), Clues(), 1)
        assert found[0].place == pytest.approx(place, abs=error)


def test_where_no_parabola_fits_a_line_stands_at_its_bin():
    found = find_spectrum(output(np.sin(TURN * 64.0 * TIME), TIME))
    flat, bare = (replace(found, value=np.full_like(found.value, level)) for level in (1.0, 0.0))
    assert [one.refine(64.0) for one in (found, flat, bare)] == [pytest.approx(64.0), 64.0, 64.0]
    assert flat.refine(0.0) == 0.0


def test_lines_are_told_as_far_as_the_band_goes():
    """Half of the sampling rate of raw samples, which say so; the band of those that were filtered before."""
    part = make_dataset().sel(time=slice(STEADY, None))
    signal = output(np.cos(TURN * 103.0 * TIME) + np.cos(TURN * 3300.0 * TIME), TIME)
    for attributes, end, count in (({}, 4096.0, 2), ({"band_hz": 3276.8}, 3276.8, 1)):
        clues = find_clues(part.assign_attrs(attributes))
        assert clues.band.end_hz == pytest.approx(end, rel=1e-3)
        assert clues.band.raw == (not attributes)
        assert len(name_lines(find_spectrum(signal), clues)) == count


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


# --- orders


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


# --- waterfall


def test_a_run_up_draws_a_straight_line():
    time, angle, speed = run_up(5.0, 40.0)
    dataset = result(
        time,
        mesh_force={"psh.mesh": np.sin(20.0 * angle)},
        mesh_phase={"psh.mesh": 20.0 * angle / TURN},
        speed={"psh.input": speed},
    )
    force, turning = select_output(dataset, "mesh_force:psh.mesh")[0], select_output(dataset, "speed:psh.input")[0]
    found = find_waterfall(force, turning, resolution_hz=16.0)
    ridge = found.frequency[np.argmax(found.amplitude[:, 1:], axis=1) + 1]
    course = mesh_courses(dataset, found)["psh"]
    assert np.abs(ridge - course).max() <= 16.0
    assert course == pytest.approx(20.0 * found.speed / 60.0, rel=1e-3)
    assert course == pytest.approx(20.0 * (5.0 + 17.5 * found.time), rel=1e-3)
    assert found.bandwidth == pytest.approx(24.0)
    assert found.shaft == "psh.input"
    assert np.diff(found.time) == pytest.approx(0.25 * found.segment_s)


def test_every_spectrum_of_a_steady_sine_is_the_same():
    found = find_waterfall(output(2.0 * np.sin(TURN * 512.0 * TIME), TIME), resolution_hz=8.0)
    assert found.amplitude[:, 64] == pytest.approx(2.0)
    assert found.amplitude.shape == (29, 513)


@pytest.mark.parametrize("resolution", [0.5, 1000.0, 0.0, -1.0])
def test_resolutions_that_cannot_be_are_refused(resolution):
    with pytest.raises(LtcgearError, match=r"--resolution .* must lie between 1 and 128 Hz"):
        find_waterfall(output(TIME, TIME), resolution_hz=resolution)


# --- envelope


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
