"""Sobol indices of sweeps, against functions whose indices are known in closed form, and how failed runs count."""

import math

import numpy as np
import pytest
from ltcgear.generated.errors import LtcgearError
from ltcgear.runtime.studies.sweep.design import draw_design
from ltcgear.runtime.studies.sweep.influence import FEWEST, find_influences
from ltcgear.runtime.studies.sweep.summary import summarise
from ltcgear.runtime.studies.sweep.sweep_axes import read_axes
from ltcgear.runtime.view.tables.sweep_tables import list_tables

from ..sweeps import as_sweep

A, B = 7.0, 0.1
WEIGHTS = np.array([0.0, 1.0, 4.5, 9.0])


def ishigami(x):
    """Ishigami and Homma 1990: sin x1 + a sin^2 x2 + b x3^4 sin x1, x in (-pi, pi)."""
    return np.sin(x[:, 0]) + A * np.sin(x[:, 1]) ** 2 + B * x[:, 2] ** 4 * np.sin(x[:, 0])


def ishigami_indices():
    """Its first-order and total indices from its variance components (Saltelli et al. 2008, section 4.6)."""
    one = 0.5 * (1.0 + B * math.pi**4 / 5.0) ** 2
    two, both = A**2 / 8.0, B**2 * math.pi**8 * (1.0 / 18.0 - 1.0 / 50.0)
    variance = one + two + both
    return np.array([one, two, 0.0]) / variance, np.array([one + both, two, both]) / variance


def g_function(x):
    """Sobol's g-function, the product of (|4 x - 2| + a) / (1 + a), x in (0, 1)."""
    return np.prod((np.abs(4.0 * x - 2.0) + WEIGHTS) / (1.0 + WEIGHTS), axis=1)


def g_indices():
    """Its indices: V_i = 1 / (3 (1 + a_i)^2), V = prod (1 + V_i) - 1, V_Ti = V_i prod of the others' (1 + V_j)."""
    own = 1.0 / (3.0 * (1.0 + WEIGHTS) ** 2)
    whole = np.prod(1.0 + own)
    return own / (whole - 1.0), own * whole / (1.0 + own) / (whole - 1.0)


def test_the_printed_indices_of_ishigami():
    """0.3139, 0.4424, 0 and 0.5576, 0.4424, 0.2437, as printed for a = 7 and b = 0.1 (Saltelli et al. 2008)."""
    first, total = ishigami_indices()
    assert first == pytest.approx([0.3139, 0.4424, 0.0], abs=5e-5)
    assert total == pytest.approx([0.5576, 0.4424, 0.2437], abs=5e-5)


@pytest.fixture(scope="module")
def known():
    """A sweep of the Ishigami function, with a metric that does not vary."""
    design = draw_design(read_axes([f"x.{k}=-{math.pi}:{math.pi}" for k in (1, 2, 3)]), "saltelli", 2048, 4)
    return design, as_sweep(design, response=ishigami(design.values), still=np.full(design.size, 3.0))


def test_indices_of_ishigami(known):
    found, _ = find_influences(known[1])
    first, total = ishigami_indices()
    assert (found.metric, found.axes, found.blocks, found.dropped) == ("response", ("x.1", "x.2", "x.3"), 2048, 0)
    assert found.first == pytest.approx(first, abs=0.03)
    assert found.total == pytest.approx(total, abs=0.03)
    assert np.all(np.abs(found.first - first) < 1.5 * found.first_confidence)
    assert np.all(found.first_confidence < 0.1)


def test_indices_of_the_g_function_with_units_and_items():
    """Ranges of any unit and place are the same function of the unit interval."""
    design = draw_design(read_axes(["a=-2 m:2 m", "b=5:6", "c=1 rpm:3 rpm", "d=0 um:1 um"]), "saltelli", 2048, 9)
    unit = (design.values - [-2.0, 5.0, 1.0, 0.0]) / [4.0, 1.0, 2.0, 1.0]
    values = np.stack([g_function(unit), 1e6 - 3.0 * g_function(unit)], axis=1)
    first, total = g_indices()
    for found in find_influences(as_sweep(design, force=(["one", "two"], values))):
        assert found.first == pytest.approx(first, abs=0.03)
        assert found.total == pytest.approx(total, abs=0.03)


def test_what_does_not_vary_has_no_indices(known):
    _, still = find_influences(known[1])
    assert np.isnan([*still.first, *still.total, *still.first_confidence, *still.total_confidence]).all()


def test_a_failed_run_takes_its_block_along(known):
    """Blocks that are left give the indices that they give alone; values of failed runs are not looked at."""
    design, _ = known
    values, status = ishigami(design.values), ["done"] * design.size
    values[7], values[23] = 1e12, np.nan
    status[7] = "no equilibrium"
    found, *_ = find_influences(as_sweep(design, status, response=values))
    assert (found.blocks, found.dropped) == (2046, 2)
    assert found.first == pytest.approx(ishigami_indices()[0], abs=0.03)
    table = list_tables(as_sweep(design, status, response=values))[-1]
    assert any("2 blocks; the indices are of the rest" in note for note in table.notes)


def test_too_few_whole_blocks_are_refused(known):
    design, _ = known
    status = ["done" if point >= 5 * (2048 - FEWEST + 1) else "stopped" for point in range(design.size)]
    sweep = as_sweep(design, status, response=ishigami(design.values))
    with pytest.raises(LtcgearError, match=f"{FEWEST - 1} of 2048 blocks of 5 runs are whole, {FEWEST} at least"):
        find_influences(sweep)
    assert "blocks of 5 runs are whole" in summarise(sweep)["without_influences"]
    assert "blocks of 5 runs are whole" in list_tables(sweep)[-1].notes[0]


def test_a_number_that_few_runs_have_takes_no_other_along(known):
    design, _ = known
    lone = np.where(np.arange(design.size) < 50, design.values[:, 0], np.nan)
    found, few = find_influences(as_sweep(design, response=ishigami(design.values), lone=lone))
    assert found.blocks == 2048
    assert (few.blocks, few.dropped) == (10, 2038)
    assert np.isnan(few.first).all()


def test_other_samples_have_no_indices():
    design = draw_design(read_axes(["a=0:1"]), "lhs", 8)
    sweep = as_sweep(design, response=design.values[:, 0])
    with pytest.raises(LtcgearError, match="need a sweep with --sample saltelli; this one is of lhs"):
        find_influences(sweep)
    assert "influences" not in summarise(sweep)


def test_the_summary_holds_indices(known):
    found = summarise(known[1])["influences"]
    assert [one["metric"] for one in found] == ["response", "still"]
    assert found[0]["axes"]["x.2"]["first"] == pytest.approx(0.4424, abs=0.03)
    assert found[1]["axes"]["x.2"]["first"] is None


def test_a_sweep_under_way_has_no_indices_yet(known):
    """Its rows would be taken for blocks that they are not."""
    _, sweep = known
    part = sweep.isel(point=np.delete(np.arange(sweep.sizes["point"]), [3, 500, 501, 900, 2000]))
    with pytest.raises(LtcgearError, match="need all runs"):
        find_influences(part)
    assert "need all runs" in summarise(part)["without_influences"]
    assert list_tables(part)
