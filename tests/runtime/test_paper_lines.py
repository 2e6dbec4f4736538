"""Lines of Table 8: what each is said to be."""

from types import SimpleNamespace

import numpy as np
import pytest
from ltcgear.runtime.comparison import published
from ltcgear.runtime.paper.lines import explain_lines, forced_name, own_peak, printed_lines

from .synthetic import make_dataset

MESHES = {"lsp": 29.5, "hsp": 158.2347, "psh": 628.2556}
TURNS = {"lsp.carrier": 0.0, "hsp.carrier": 1.3409}


def mode(hz, name="a mode"):
    return SimpleNamespace(frequency_hz=hz, name=name)


def test_every_simulated_line_of_the_paper_is_told_of():
    lines = explain_lines(MESHES, TURNS, [mode(100.0)])
    printed = {float(value) for row in published()["table8"]["rows"] for value in row.get("simulated", [])}
    assert [line.frequency_hz for line in lines] == sorted(printed)
    assert len(printed) == 14
    kinds = {line.frequency_hz: (line.kind, line.name) for line in lines}
    assert kinds[59.2] == ("harmonic", "2 lsp")
    assert kinds[474.4] == ("harmonic", "3 hsp")
    assert kinds[413.2] == ("harmonic", "14 lsp")
    assert kinds[506.6] == ("sideband", "3 hsp + 1 lsp")
    assert kinds[500.0][0] == kinds[557.5][0] == "unexplained"
    assert sum(line.kind == "unexplained" for line in lines) == 2


def test_distances_are_those_of_what_explains():
    lines = {line.frequency_hz: line for line in explain_lines(MESHES, TURNS, [mode(100.0), mode(552.0, "near")])}
    assert lines[59.2].off == pytest.approx(59.0 / 59.2 - 1)
    assert lines[506.6].off == pytest.approx((3 * 158.2347 + 29.5) / 506.6 - 1)
    assert (lines[557.5].kind, lines[557.5].name) == ("mode", "near")
    assert lines[557.5].off == pytest.approx(552.0 / 557.5 - 1)


def test_high_orders_explain_nothing_unless_they_are_sharp():
    assert forced_name(413.2, MESHES, TURNS) == ""
    assert forced_name(59.2, MESHES, TURNS) == "2 lsp"
    assert forced_name(156.3, MESHES, TURNS) == "hsp - 1 hsp.carrier"


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
    frequency, share = own_peak(dataset, [member], 59.2, start)
    assert frequency == pytest.approx(59.0, abs=1.0)
    assert share == pytest.approx(0.1, rel=0.2)
    assert own_peak(dataset, ["nobody"], 59.2, start) == (0.0, 0.0)
