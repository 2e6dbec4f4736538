"""Axes and designs of sweeps: what is read, what is refused, and which points are drawn."""

import json
import re
from dataclasses import replace
from importlib.util import find_spec
from math import sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from ltcgear.generated.errors import LtcgearError
from ltcgear.runtime.studies.sweep.design import SAMPLES, Design, draw_design
from ltcgear.runtime.studies.sweep.sweep_axes import SweepAxis, read_axes, read_axis
from ltcgear.symbolic.schema.units import parse

NUMBERS = st.floats(-1e6, 1e6, allow_subnormal=False)
UNITS = st.sampled_from(["", "um", "rpm", "N*m/rad", "1/s"])


@st.composite
def ranges(draw, count=None):
    low, high = sorted(draw(st.lists(NUMBERS, min_size=2, max_size=2, unique=True)))
    points = None if count is None else draw(count)
    return SweepAxis(draw(st.sampled_from(["a", "stages.lsp.x"])), low, high, draw(UNITS), points)


@given(ranges(st.none() | st.integers(2, 50)))
@settings(deadline=None)
def test_ranges_are_read_as_they_are_written(axis):
    text = f"{axis.key}={axis.write(axis.low)}:{axis.write(axis.high)}" + (f":{axis.count}" if axis.count else "")
    assert read_axis(text) == axis
    assert SweepAxis.from_json(json.loads(json.dumps(axis.to_json()))) == axis


@given(NUMBERS.filter(lambda value: value == 0.0 or abs(value) >= 1e-30), st.sampled_from(["m", "N*m", "rad/s"]))
@settings(deadline=None)
def test_scenes_read_back_the_very_number(value, unit):
    written = SweepAxis("a", unit=unit).write(value)
    assert parse(written, unit) == value


@given(ranges(), st.sampled_from(["lhs", "sobol", "saltelli"]), st.integers(1, 40), st.integers(0, 2**32))
@settings(max_examples=60, deadline=None)
def test_bounds_are_kept_and_seeds_reproduce(axis, sample, points, seed):
    axes = (axis, SweepAxis("other", 0.0, 1.0))
    design = draw_design(axes, sample, points, seed)
    assert design.size == points * (4 if sample == "saltelli" else 1)
    assert design.values[:, 0].min() >= axis.low
    assert design.values[:, 0].max() <= axis.high
    assert design == draw_design(axes, sample, points, seed)
    assert design == Design.from_json(json.dumps(design.to_json()))
    assert design != draw_design(axes, sample, points, seed + 1)
    assert design.changes(0)["other"] == axes[1].write(float(design.values[0, 1]))


@given(st.integers(1, 64), st.integers(0, 99))
@settings(max_examples=25, deadline=None)
def test_every_stratum_of_a_latin_hypercube_is_hit_once(points, seed):
    design = draw_design(read_axes(["a=-3 m:5 m", "b=10:11"]), "lhs", points, seed)
    unit = (design.values - [-3.0, 10.0]) / [8.0, 1.0]
    for column in np.floor(unit * points).T:
        assert sorted(column) == list(range(points))


def test_sobol_points_fill_elementary_intervals():
    """A (0, m, 2) net in base 2 has one of 2^m points in each elementary interval; Sobol's first two axes make one."""
    unit = draw_design(read_axes(["a=0:1", "b=0:1"]), "sobol", 64, 5).values
    for k in range(7):
        cells = np.floor(unit[:, 0] * 2**k) * 2 ** (6 - k) + np.floor(unit[:, 1] * 2 ** (6 - k))
        assert sorted(cells) == list(range(64))


def test_powers_of_two_are_advised():
    axes = read_axes(["a=0:1", "b=0:1"])
    for sample in ("sobol", "saltelli"):
        assert "64 or 128" in draw_design(axes, sample, 100).notes[0]
        assert draw_design(axes, sample, 128).notes == ()
    assert draw_design(axes, "lhs", 100).notes == ()


def test_normal_draws_have_their_mean_and_deviation():
    points = 4000
    design = draw_design(read_axes(["a=5 um:20 um", "b=-1:0.5"]), "normal", points, 11)
    scaled = (design.values - [5.0, -1.0]) / [20.0, 0.5]
    assert np.abs(scaled.mean(axis=0)).max() < 4.0 / sqrt(points)
    assert np.abs(scaled.std(axis=0) - 1.0).max() < 4.0 / sqrt(2 * points)
    assert abs(np.corrcoef(scaled.T)[0, 1]) < 4.0 / sqrt(points)
    assert np.mean(np.abs(scaled) < 1.0) == pytest.approx(0.6827, abs=0.02)


def test_saltelli_blocks_are_a_point_its_neighbours_and_its_partner():
    design = draw_design(read_axes(["a=0:1", "b=0:1", "c=0:1"]), "saltelli", 8, 2)
    for block in design.values.reshape(8, 5, 3):
        own, *crossed, partner = block
        for k, row in enumerate(crossed):
            assert np.array_equal(row, np.where(np.arange(3) == k, partner, own))


def test_grids_cross_and_the_first_axis_is_the_slowest():
    design = draw_design(read_axes(["a=0 m:1 m:3", "effects.x=on,off", "n=3:5:3"]))
    assert design.size == 18
    assert design.changes(0) == {"a": "0 m", "effects.x": "on", "n": "3"}
    assert design.changes(1) == {"a": "0 m", "effects.x": "on", "n": "4"}
    assert design.changes(17) == {"a": "1 m", "effects.x": "off", "n": "5"}
    dimension, words, attributes = design.coordinates()["effects.x"]
    assert (dimension, attributes) == ("point", {"key": "effects.x"})
    assert set(words) == {"on", "off"}


def test_drawn_points_are_the_same_at_each_crossing():
    design = draw_design(read_axes(["e=0 um:9 um", "effects.x=on,off"]), "lhs", 7, 3)
    values = design.values.reshape(2, 7, 2)
    assert np.array_equal(values[0, :, 0], values[1, :, 0])
    assert values[:, :, 1].tolist() == [[0.0] * 7, [1.0] * 7]


def test_lists_of_numbers_are_coordinates_with_a_unit():
    design = draw_design(read_axes(["t=2 m,0.5 m", "u=1 m,2"]))
    assert np.array_equal(design.coordinates()["t"][1], [2.0, 2.0, 0.5, 0.5])
    assert design.coordinates()["t"][2]["units"] == "m"
    assert design.coordinates()["u"][1].dtype.kind == "U"


def test_ends_reach_every_bound_and_every_item():
    design = draw_design(read_axes(["e=0 um:9 um", "effects.x=on,off,paper"]), "lhs", 5, 3)
    ends = design.ends()
    assert {end["effects.x"] for end in ends} == {"on", "off", "paper"}
    drawn = [design.changes(point)["e"] for point in range(design.size)]
    assert {min(drawn, key=_number), max(drawn, key=_number)} <= {end["e"] for end in ends}
    assert {"0 um", "9 um"} <= {end["e"] for end in ends}


def _number(text):
    return float(text.split()[0])


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("a", "no key of the scene"),
        ("=1:2", "no key of the scene"),
        ("a..b=1:2", "no key of the scene"),
        ("a=", "no values"),
        ("a=1:2:3:4", "4 parts"),
        ("a=1 m:2", "units 'm' and 'none'"),
        ("a=1 m:2 mm", "write both in the same"),
        ("a=x:2", "'x' is not a number"),
        ("a=inf:2", "'inf' is not finite"),
        ("a=0:1e999", "'1e999' is not finite"),
        ("a=nan m:2 m", "not finite"),
        ("a=2:1:3", "empty"),
        ("a=1:1:3", "empty"),
        ("a=1:2:0", "'0' points"),
        ("a=1:2:-4", "'-4' points"),
        ("a=1:2:2.5", "'2.5' points"),
        ("a=1:2:1", "range of one point"),
        ("a=1:2:99999999", "1000000"),
        ("a=on,,off", "a value of the list is empty"),
        ("a=on,off,on", "on is given twice"),
        ("a=1 rpm,2 rpm,1.0 rpm", "1 rpm is given twice"),
        ("a=1,-inf", "-inf is not finite"),
    ],
)
def test_axes_that_are_none_are_refused(text, reason):
    with pytest.raises(LtcgearError, match=f"^--vary .*{re.escape(reason)}"):
        read_axis(text)


def test_keys_are_varied_once():
    with pytest.raises(LtcgearError, match="--vary a: is given 2 times; give each key once"):
        read_axes(["a=1:2", "b=1:2", "a=3:4"])
    with pytest.raises(LtcgearError, match="one key of the scene at least"):
        read_axes([])


@pytest.mark.parametrize(
    ("texts", "sample", "points", "reason"),
    [
        (["a=1 m:2 m"], "grid", None, "write a='1 m:2 m:11'"),
        (["a=1:2:3"], "grid", 9, "--points 9: a grid has the points of its axes"),
        (["a=1:2"], "lhs", None, "--points 128"),
        (["a=1:2"], "lhs", 0, "--points 0"),
        (["a=1:2:3"], "lhs", 9, "every axis has its own points"),
        (["a=1:1"], "sobol", 8, "empty"),
        (["a=1:0"], "normal", 8, "standard deviation 0 must be greater than zero"),
        (["a=1:2", "b=on,off"], "saltelli", 8, "Sobol indices are of ranges"),
        (["a=1:2"], "random", 8, "there are grid, lhs"),
        (["a=1:2:2000", "b=1:2:2000"], "grid", None, "4e+06 points"),
    ],
)
def test_designs_that_are_none_are_refused(texts, sample, points, reason):
    with pytest.raises(LtcgearError, match=re.escape(reason)):
        draw_design(read_axes(texts), sample, points)
    assert sample in SAMPLES or sample == "random"


def test_seeds_are_whole_numbers():
    with pytest.raises(LtcgearError, match="--seed -1"):
        draw_design(read_axes(["a=1:2"]), "lhs", 4, -1)


def test_other_points_than_those_kept_are_refused():
    kept = draw_design(read_axes(["a=1:2"]), "lhs", 4, 1).to_json()
    with pytest.raises(LtcgearError, match="other versions of NumPy"):
        Design.from_json(kept | {"digest": "0"})


def test_points_are_those_kept_up_to_last_bits():
    design = draw_design(read_axes(["a=1:0.2"]), "normal", 400, 1)
    other = replace(design, values=np.nextafter(design.values, np.inf))
    assert (other.values != design.values).all()
    assert other == design
    assert Design.from_json(design.to_json() | {"digest": design._digest("<f8")}) == design


def test_without_salib_the_extra_is_named(monkeypatch):
    assert find_spec("SALib")
    monkeypatch.setitem(__import__("sys").modules, "SALib.sample.sobol", None)
    with pytest.raises(LtcgearError, match=re.escape("pip install 'ltcgear[sweep]'")):
        draw_design(read_axes(["a=1:2"]), "saltelli", 4)
