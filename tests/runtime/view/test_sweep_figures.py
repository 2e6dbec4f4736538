"""What a sweep shows: summaries, tables and figures, each as suits its design."""

import json

import numpy as np
import pytest
from ltcgear.runtime.results.amplitude_spectrum import amplitude_spectrum
from ltcgear.runtime.studies.sweep.design import draw_design
from ltcgear.runtime.studies.sweep.summary import summarise
from ltcgear.runtime.studies.sweep.sweep_axes import read_axes
from ltcgear.runtime.studies.sweep.sweep_reading import shorten
from ltcgear.runtime.view.figures.sweep_figures import draw_sweep
from ltcgear.runtime.view.tables.sweep_tables import list_tables
from matplotlib.colors import to_hex

from ..sweeps import as_sweep

PLANETS = [f"lsp.sun_planet.{number}" for number in (1, 2, 3, 4)]


def spread(points=200):
    """A Monte Carlo sweep: two runs failed, a single number and one with items."""
    design = draw_design(read_axes(["a=10 um:2 um", "b=0:1"]), "normal", points, 3)
    status = ["done"] * points
    status[4], status[9] = "no equilibrium", "no equilibrium"
    values = design.values[:, 0].copy()
    values[4] = 1e9
    shares = 1.0 + 0.01 * np.outer(values, [1.0, -1.0, 1.0, -1.0])
    return design, as_sweep(design, status, factor=values, load_share=(PLANETS, shares))


def test_summaries_are_of_the_runs_that_are_done():
    design, sweep = spread()
    kept = np.delete(design.values[:, 0], [4, 9])
    found = summarise(sweep)
    assert json.loads(json.dumps(found, allow_nan=False)) == found
    assert (found["points"], found["failed"], found["reasons"]) == (200, 2, {"no equilibrium": 2})
    one = found["metrics"]["factor"]
    assert one["count"] == 198
    assert one["mean"] == pytest.approx(sum(kept) / 198)
    assert one["std"] == pytest.approx(np.sqrt(sum((kept - sum(kept) / 198) ** 2) / 197))
    ordered = sorted(kept)
    assert (one["min"], one["max"]) == (ordered[0], ordered[-1])
    assert one["median"] == pytest.approx(0.5 * (ordered[98] + ordered[99]))
    assert np.mean(kept < one["p5"]) == pytest.approx(0.05, abs=0.006)
    assert np.mean(kept > one["p95"]) == pytest.approx(0.05, abs=0.006)
    assert set(found["metrics"]["load_share"]["items"]) == set(PLANETS)


def test_a_metric_that_no_run_gave_is_null():
    design = draw_design(read_axes(["a=0:1:3"]))
    found = summarise(as_sweep(design, ["stopped"] * 3, factor=np.full(3, np.nan)))
    assert found["metrics"]["factor"]["mean"] is None
    assert found["metrics"]["factor"]["count"] == 0
    sweep = as_sweep(design, ["stopped"] * 3, factor=np.full(3, np.nan))
    sweep["spectrum:speed:x"] = (("point", "frequency"), np.full((3, 9), np.nan))
    assert draw_sweep(sweep) == {}
    assert list_tables(sweep)[0].notes == ("3 of 3 runs failed and are left out",)


def test_tables_over_drawn_points_have_a_row_for_each_item():
    table = list_tables(spread()[1])[1]
    assert table.columns == ("", "mean", "deviation", "min", "5 %", "median", "95 %", "max")
    assert [row[0] for row in table.rows] == PLANETS
    assert table.notes == ("2 of 200 runs failed and are left out",)


def test_tables_over_one_axis_have_a_row_for_each_point():
    design = draw_design(read_axes(["loads.x.speed=10 rpm:50 rpm:41"]))
    speed = design.values[:, 0]
    sweep = as_sweep(design, force=(PLANETS, 1e3 * np.outer(speed, [1, 2, 3, 4])), factor=speed)
    table, single = list_tables(sweep)
    assert table.columns == ("loads.x.speed [rpm]", "1", "2", "3", "4")
    assert table.rows[0] == (10.0, 10e3, 20e3, 30e3, 40e3)
    assert table.rows[-1][0] == 50.0
    assert len(table.rows) == 21
    assert table.notes[0] == "one point of 2; the file has all"
    assert single.columns == ("loads.x.speed [rpm]", "factor")


def test_drawn_points_give_distributions():
    design, sweep = spread()
    figures = draw_sweep(sweep)
    assert set(figures) == {"factor", "load_share"}
    counted, summed = figures["factor"].axes
    assert counted.patches[0].get_data().values.sum() == 198
    places, share = summed.lines[0].get_data()
    assert places[1:].tolist() == sorted(np.delete(design.values[:, 0], [4, 9]))
    assert (share[0], share[-1]) == (0.0, 1.0)
    assert summed.get_title(loc="left") == "198 runs, 2 more failed, normal"
    assert [text.get_text() for text in figures["load_share"].axes[1].get_legend().get_texts()] == PLANETS


def test_one_axis_gives_responses_and_waterfalls():
    """A line that goes with the mesh is drawn where the mesh frequency's mark is."""
    design = draw_design(read_axes(["loads.x.speed=10 rpm:40 rpm:7"]))
    mesh, time = 2.0 * design.values[:, 0], np.arange(1024) / 1024.0
    spectra = [amplitude_spectrum(np.sin(2.0 * np.pi * f * time), 1024.0, "hann") for f in mesh]
    sweep = as_sweep(design, factor=design.values[:, 0] ** 2)
    sweep["spectrum:speed:x"] = (("point", "frequency"), [one for _, one in spectra], {"units": "m", "long_name": "s"})
    sweep["mesh_frequency"] = (("point", "gear_set"), mesh[:, None])
    sweep = sweep.assign_coords(frequency=spectra[0][0], gear_set=["x"])
    figures = draw_sweep(sweep)
    assert set(figures) == {"factor", "spectrum-speed-x"}
    assert figures["factor"].axes[0].lines[0].get_ydata().tolist() == (design.values[:, 0] ** 2).tolist()
    axes = figures["spectrum-speed-x"].axes[0]
    assert axes.get_ylabel() == "loads.x.speed [rpm]"
    marks = [line for line in axes.lines if len(line.get_xdata()) == 7]
    assert [mark.get_xdata().tolist() for mark in marks] == [(h * mesh).tolist() for h in (1, 2, 3)]
    outlines = [patch.get_xy() for patch in axes.patches]
    for outline in outlines:
        top = outline[np.argmax(outline[:, 1]), 0]
        assert min(abs(top - mesh)) <= 2.0


def test_words_on_an_axis_stand_side_by_side():
    design = draw_design(read_axes(["effects.mesh_stiffness=mean,smooth"]))
    axes = draw_sweep(as_sweep(design, force=(PLANETS, np.ones((2, 4)))))["force"].axes[0]
    assert [label.get_text() for label in axes.get_xticklabels()] == ["mean", "smooth"]
    assert len({line.get_xdata()[0] for line in axes.lines}) == 4


def test_drawn_points_over_an_axis_give_medians_and_quantiles():
    design = draw_design(read_axes(["a=0:1", "n=3:5:3"]), "lhs", 101, 2)
    level, drawn = design.values[:, 1], design.values[:, 0]
    sweep = as_sweep(design, factor=level * drawn)
    figure = draw_sweep(sweep)["factor"]
    bars = figure.axes[0].containers[0]
    assert bars.lines[0].get_xdata().tolist() == [3.0, 4.0, 5.0]
    assert bars.lines[0].get_ydata() == pytest.approx([1.5, 2.0, 2.5], rel=0.02)
    ends = np.array([segment[:, 1] for segment in bars.lines[2][0].get_segments()])
    assert ends == pytest.approx(np.outer([3.0, 4.0, 5.0], [0.05, 0.95]), abs=0.06)
    assert list_tables(sweep)[0].notes == ("over all values of n",)


def test_keys_are_told_without_what_they_share():
    keys = ("stages.lsp.pin.stiffness", "stages.lsp.position_errors.0.radial")
    assert shorten(keys) == ("stages.lsp.", ("pin.stiffness", "position_errors.0.radial"))
    assert shorten(("a.b",)) == ("a.", ("b",))
    assert shorten(("a", "a.b")) == ("", ("a", "a.b"))


def test_two_axes_give_a_map():
    """A third one with a single value changes nothing."""
    design = draw_design(read_axes(["a=0 m:1 m:3", "effects.y=on", "effects.x=on,off"]))
    values = np.arange(6.0)
    figure = draw_sweep(as_sweep(design, factor=values))["factor"]
    image = figure.axes[0].collections[0]
    assert image.get_array().tolist() == [[0.0, 2.0, 4.0], [1.0, 3.0, 5.0]]
    assert [label.get_text() for label in figure.axes[0].get_yticklabels()] == ["on", "off"]
    assert figure.axes[0].get_xlabel() == "a [m]"


def test_saltelli_gives_bars_with_their_confidence():
    design = draw_design(read_axes(["a=0:1", "b=0:1"]), "saltelli", 128, 1)
    sweep = as_sweep(design, factor=design.values @ [3.0, 1.0], still=np.ones(design.size))
    figures = draw_sweep(sweep)
    assert set(figures) == {"factor", "still", "sobol-factor"}
    widths = [bar.get_width() for bar in figures["sobol-factor"].axes[0].patches]
    assert widths == pytest.approx([0.9, 0.1, 0.9, 0.1], abs=0.05)
    assert len({to_hex(bar.get_facecolor()) for bar in figures["sobol-factor"].axes[0].patches}) == 2


def test_what_varies_by_rounding_only_is_drawn():
    design = draw_design(read_axes(["a.b=0:1", "a.c=0:1"]), "lhs", 20)
    sweep = as_sweep(design, factor=1.0 + 1e-16 * np.arange(20.0), none=np.zeros(20))
    for figure in draw_sweep(sweep).values():
        assert figure.axes[0].get_xlim()[0] < figure.axes[0].get_xlim()[1]


def test_a_grid_under_way_is_drawn_without_maps():
    design = draw_design(read_axes(["a.b=0:1:5", "a.c=0:1:4"]))
    sweep = as_sweep(design, factor=np.arange(20.0))
    assert len(draw_sweep(sweep)["factor"].axes) == 2  # the map and its scale
    assert draw_sweep(sweep.isel(point=[0, 3, 4, 9, 11]))["factor"].axes[0].get_ylabel() == "runs"
