"""Names of spectral lines: mesh harmonics, sidebands, orders of shafts, sampling."""

from dataclasses import replace

import numpy as np
import pytest
from ltcgear.runtime.analysis import (
    find_clues,
    find_spectrum,
    name_lines,
    select_output,
)
from ltcgear.runtime.analysis.lines import Clues
from ltcgear.runtime.linear.modes import Mode
from ltcgear.runtime.results.amplitude_spectrum import Sources, explain_line

from ..outputs import output, times
from ..synthetic import FREE, HSP, LSP, PSH, STEADY, make_dataset

TIME = times()
TURN = 2 * np.pi


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
