"""Lines of Table 8: what each is said to be."""

from types import SimpleNamespace

import numpy as np
import pytest
from ltcgear.runtime.results.amplitude_spectrum import Sources
from ltcgear.runtime.studies.wu2021.comparison import published
from ltcgear.runtime.studies.wu2021.line_origins import (
    count_chance,
    explain_lines,
    forced_name,
    own_peak,
    printed_lines,
)

from ..synthetic import make_dataset

MESHES = {"lsp": 29.5, "hsp": 158.2347, "psh": 628.2556}
TURNS = {"lsp.carrier": 0.0, "hsp.carrier": 1.3409}
SOURCES = Sources(MESHES, TURNS, stages={"lsp.carrier": "lsp", "hsp.carrier": "hsp"})


def mode(hz, name="a mode"):
    return SimpleNamespace(frequency_hz=hz, name=name)


def test_every_simulated_line_of_the_paper_is_told_of():
    lines = explain_lines(SOURCES, [mode(100.0)])
    printed = {float(value) for row in published()["table8"]["rows"] for value in row.get("simulated", [])}
    assert [line.frequency_hz for line in lines] == sorted(printed)
    assert len(printed) == 14
    kinds = {line.frequency_hz: (line.kind, line.name) for line in lines}
    assert kinds[59.2] == ("harmonic", "2 lsp")
    assert kinds[474.4] == ("harmonic", "3 hsp")
    assert kinds[413.2] == ("sideband", "3 hsp - 2 lsp or 14 lsp")  # both hold, each by its own rule
    assert kinds[500.0] == kinds[506.6] == ("sideband", "3 hsp + 1 lsp")
    assert kinds[557.5][0] == "unexplained"
    assert sum(line.kind == "unexplained" for line in lines) == 1


def test_no_low_order_within_one_per_cent_is_passed_over():
    """Every combination that the rule allows, written out once more."""
    turning = {"lsp": MESHES["lsp"], "hsp": MESHES["hsp"], "psh": MESHES["psh"]}
    low = [order * value for value in turning.values() for order in range(1, 6)]
    for one, middle in turning.items():
        for other, side in turning.items():
            if side < middle and one != other:
                low += [n * middle + s * m * side for n in range(1, 6) for m in range(1, 4) for s in (1, -1)]
    low += [n * MESHES["hsp"] + s * m * 1.3409 for n in range(1, 6) for m in range(1, 4) for s in (1, -1)]
    for place in np.arange(25.0, 650.0, 0.7):
        allowed = any(abs(value - place) <= 0.01 * place for value in low)
        assert bool(forced_name(float(place), SOURCES)) == allowed, place


def test_distances_are_those_of_what_explains():
    lines = {line.frequency_hz: line for line in explain_lines(SOURCES, [mode(100.0), mode(552.0, "near")])}
    assert lines[59.2].off == pytest.approx(59.0 / 59.2 - 1)
    assert lines[506.6].off == pytest.approx((3 * 158.2347 + 29.5) / 506.6 - 1)
    assert (lines[557.5].kind, lines[557.5].name) == ("mode", "near")
    assert lines[557.5].off == pytest.approx(552.0 / 557.5 - 1)


def test_high_orders_explain_nothing_unless_they_are_sharp():
    lone = {"lsp": 29.5}
    assert forced_name(413.2, Sources(lone)) == ""
    assert [
        (line.kind, line.name) for line in explain_lines(Sources(lone), [mode(100.0)]) if line.frequency_hz == 413.2
    ] == [("harmonic", "14 lsp")]
    assert forced_name(59.2, SOURCES) == "2 lsp"
    assert forced_name(156.3, SOURCES) == "hsp - 1 hsp.carrier"


def test_lines_are_listed_once_with_all_their_places():
    lines = printed_lines()
    assert list(lines) == sorted(lines)
    assert len(lines[62.5]) == 4
    assert lines[316.5] == ["simulated, HSP: ring gear"]


def test_our_peak_is_looked_for_next_to_the_line():
    dataset = make_dataset()
    member = str(dataset["member"].values[0])
    time = dataset["time"].values
    dataset["acceleration_x"].loc[{"member": member}] = 3.0 * np.sin(2 * np.pi * 200.0 * time)
    dataset["acceleration_y"].loc[{"member": member}] = 0.3 * np.sin(2 * np.pi * 59.0 * time)
    start = float(time[-1]) / 2
    frequency, share = own_peak(dataset, [member], 59.2, start)  # the stronger 200 Hz are not next to it
    assert frequency == pytest.approx(59.0, abs=1.0)
    assert share == pytest.approx(0.1, rel=0.2)
    assert own_peak(dataset, ["nobody"], 59.2, start) is None


def test_the_skirt_of_a_line_and_dust_are_no_peaks():
    dataset = make_dataset()
    member = str(dataset["member"].values[0])
    time = dataset["time"].values
    dust = 5e-4 * np.sin(2 * np.pi * 59.0 * time)
    dataset["acceleration_x"].loc[{"member": member}] = np.sin(2 * np.pi * 197.0 * time) + dust
    dataset["acceleration_y"].loc[{"member": member}] = 0.0
    start = float(time[-1]) / 2
    assert own_peak(dataset, [member], 197.5, start)[0] == pytest.approx(197.0)
    assert own_peak(dataset, [member], 199.0, start) is None  # 197.01 Hz to 200.99 Hz: the line's skirt
    assert own_peak(dataset, [member], 59.2, start) is None


def test_chance_is_counted_over_the_frequencies_between_the_lines():
    found = count_chance(Sources({"one": 300.0}), [mode(100.0), mode(400.0), mode(5000.0), mode(0.0)])
    length = 628.1 - 29.5
    assert found["forced"] == pytest.approx((6.0 + 12.0 + 0.1) / length, abs=0.004)  # 300 and 600 Hz, 1 % each side
    assert found["mode"] == pytest.approx((2.0 + 8.0) / length, abs=0.004)
    assert found["modes"] == 2
