"""Metrics of sweeps: values against NumPy and closed forms, forms known before any run, and what is refused."""

import re

import numpy as np
import pytest
import xarray as xr
from ltcgear.generated.errors import LtcgearError
from ltcgear.runtime.analysis import find_load_share, find_transmission_error
from ltcgear.runtime.results.dataset import make_dataset
from ltcgear.runtime.results.result import Result
from ltcgear.runtime.results.statistics import window
from ltcgear.runtime.simulation.output_reader import no_rows
from ltcgear.runtime.simulation.simulate import simulate
from ltcgear.runtime.studies.sweep.metrics import METRICS, STATISTICS, choose_metrics, lay_out, measure, unite

from ..models import case
from ..synthetic import LSP
from ..synthetic import make_dataset as make_result

T_END, RATE = 0.03, 8192.0
NAMES = [
    *METRICS,
    *(f"{statistic}:acceleration_x:lsp.planet.1" for statistic in STATISTICS),
    *(f"{statistic}:mesh_force" for statistic in STATISTICS),
    "mean:reference_angle",
    "max:pin_force_x",
    "spectrum:acceleration:lsp.planet.1",
    "spectrum:mesh_force:lsp.ring_planet.2",
]


@pytest.fixture(scope="module")
def result():
    found = case("lsp")
    return simulate(found.library, found.model.values(), t_end=T_END, rate=RATE, method="erk")


@pytest.fixture(scope="module")
def row(result):
    return measure(result, NAMES)


def test_the_form_is_known_before_any_run(row):
    """Names, dimensions, labels, units: a row laid out without a run differs in its numbers only."""
    found = case("lsp")
    laid = lay_out(make_dataset(found.library, found.p, no_rows(found.library)), NAMES, T_END, RATE)
    xr.testing.assert_identical(laid, row.map(lambda values: values * np.nan, keep_attrs=True))
    assert all("time" not in variable.dims for variable in row.variables.values())
    assert all(variable.attrs["units"] and variable.attrs["long_name"] for variable in row.data_vars.values())


@pytest.mark.parametrize("samples", [128, 129, 130, 131])
def test_bins_are_known_for_even_and_odd_records(samples):
    found = case("lsp")
    dataset = make_dataset(found.library, found.p, no_rows(found.library))
    made = simulate(found.library, found.model.values(), t_end=samples / RATE, rate=RATE, method="erk")
    names = ["spectrum:speed:lsp.sun"]
    laid = lay_out(dataset, names, samples / RATE, RATE)
    assert np.array_equal(laid["frequency"], measure(made, names)["frequency"])


def test_forces_are_those_of_the_summary(result, row):
    for mesh, one in result.summary["forces"].items():
        assert float(row["load_factor"].sel(mesh=mesh)) == one["load_factor"]
        for statistic in ("mean", "min", "max", "rms", "amplitude"):
            assert float(row[f"mesh_force_{statistic}"].sel(mesh=mesh)) == one[statistic]
    loaded = Result(result.dataset, {})
    xr.testing.assert_identical(measure(loaded, ["forces"]), measure(result, ["forces"]))


def test_a_member_that_symmetry_holds_at_rest_is_told_so(result):
    """Opposite planets mesh in phase: what the sun is accelerated by is rounding, 1e-11 m/s^2."""
    found = measure(result, ["max:acceleration_x:lsp.sun", "rms:acceleration_x:lsp.planet.1"])
    assert float(found["max:acceleration_x:lsp.sun"]) == 0.0
    assert float(found["rms:acceleration_x:lsp.planet.1"]) > 0.1


def test_statistics_are_of_the_second_half(result, row):
    """Samples a hundred times as dense, weighted as the motion is, say the same."""
    found = case("lsp")
    end = round(T_END * RATE) / RATE  # of the last sample
    dense = simulate(found.library, found.model.values(), t_end=end, rate=100 * RATE, method="erk", raw=True)
    signal = dense.dataset["acceleration_x"].sel(member="lsp.planet.1").values
    half = signal[signal.size // 2 :]
    weights = np.sin(np.pi * np.arange(half.size) / (half.size - 1)) ** 4
    mean = np.average(half, weights=weights)
    by_hand = {
        "mean": mean,
        "min": half.min(),
        "max": half.max(),
        "rms": np.sqrt(np.average(half**2, weights=weights)),
        "std": np.sqrt(np.average((half - mean) ** 2, weights=weights)),
        "peak_to_peak": np.ptp(half),
    }
    for statistic, value in by_hand.items():
        near = (1e-2 if statistic in ("min", "max", "peak_to_peak") else 2e-3) * half.std()
        assert float(row[f"{statistic}:acceleration_x:lsp.planet.1"]) == pytest.approx(value, abs=near)
    pins = dense.dataset["pin_force_x"].values[half.size :]
    assert row["max:pin_force_x"].values == pytest.approx(pins.max(axis=0), abs=1e-2 * np.ptp(pins))
    assert row["max:pin_force_x"].dims == ("pin",)


def test_extremes_of_mesh_forces_see_what_lies_between_samples(result, row):
    force = window(result.dataset)["mesh_force"].values
    assert np.array_equal(row["max:mesh_force"], row["mesh_force_max"])
    assert np.array_equal(row["min:mesh_force"], row["mesh_force_min"])
    assert row["peak_to_peak:mesh_force"].values == pytest.approx(2.0 * row["mesh_force_amplitude"].values)
    assert np.any(row["max:mesh_force"].values > force.max(axis=0))


def test_shares_and_transmission_errors_are_those_of_the_analysis(result, row):
    half = window(result.dataset)
    share = find_load_share(half, "lsp.ring_planet")
    assert row["load_share"].sel(planet_mesh=list(share.meshes)).values == pytest.approx(share.mean, rel=1e-13)
    assert float(row["mesh_load_factor"].sel(group="lsp.ring_planet")) == pytest.approx(
        share.mesh_load_factor, rel=1e-13
    )
    error = find_transmission_error(half, "lsp.sun_planet.3")
    assert float(row["transmission_error"].sel(mesh="lsp.sun_planet.3")) == error.peak_to_peak


def test_costs_and_balance_are_those_of_the_run(result, row):
    assert dict(zip(row["count"].values, row["counts"].values, strict=True)) == result.summary["counts"]
    assert float(row["energy_residual"]) == result.summary["energy_residual"]


def test_spectra_have_the_lines_that_were_put_in():
    """A planet's centre shakes with 0.3 and 0.4 m/s^2 along x and y at the mesh frequency: 0.5 m/s^2 together."""
    names = ["spectrum:acceleration:lsp.planet.1", "spectrum:acceleration_x:psh.input"]
    made = measure(Result(make_result(), {}), names)
    assert float(made["spectrum:acceleration:lsp.planet.1"].sel(frequency=LSP)) == pytest.approx(0.5, rel=1e-6)
    assert float(made["spectrum:acceleration_x:psh.input"].sel(frequency=413.0)) == pytest.approx(1.5, rel=1e-6)
    assert float(made["mesh_frequency"].sel(gear_set="lsp")) == pytest.approx(LSP)


def test_metrics_that_a_scene_suggests():
    assert choose_metrics(make_result()) == ["forces", "load_share"]
    pair = make_result().sel(mesh=["psh.mesh"])
    assert choose_metrics(pair) == ["forces"]
    with pytest.raises(LtcgearError, match="no meshes that share a load"):
        measure(Result(pair, {}), ["load_share"])


def test_a_stage_without_load_has_no_shares():
    """Other metrics of such a run stay."""
    made = make_result()
    ring = np.char.startswith(made["mesh"].values.astype(str), "lsp.ring")
    made["mesh_force"] = made["mesh_force"].where(~ring, 0.0)
    found = measure(Result(made, {}), ["load_share", "mean:mesh_force"])
    carried = np.char.startswith(found["planet_mesh"].values.astype(str), "lsp.ring")
    assert np.array_equal(np.isnan(found["load_share"]), carried)
    assert np.isnan(found["mesh_load_factor"].sel(group="lsp.ring_planet"))
    assert np.isfinite(found["mean:mesh_force"]).all()


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("force", 'no such metric; did you mean "forces"?'),
        ("xyz", "there are forces, load_share"),
        ("median:speed", 'did you mean "mean"?'),
        ("rms", "of what? write rms:QUANTITY[:ITEM]"),
        ("rms:", "of what?"),
        ("spectrum", "of what? write spectrum:QUANTITY:ITEM"),
        ("forces:psh.mesh", "forces is of all meshes; write forces"),
        ("rms:acceleraton_x", 'rms:acceleraton_x: no such quantity; did you mean "acceleration_x"?'),
        ("rms:acceleration_x:lsp.snu", 'did you mean "lsp.sun"?'),
        ("rms:parameter_value", "no such quantity"),
        ("spectrum:mesh_force", "spectrum:mesh_force: write QUANTITY:ITEM"),
        ("spectrum:mesh_force:lsp.sun_planet.9", 'did you mean "lsp.sun_planet.'),
        ("", "no such metric"),
    ],
)
def test_metrics_that_are_none_are_refused_before_any_run(result, name, reason):
    with pytest.raises(LtcgearError, match="^--metric .*" + re.escape(reason)):
        lay_out(result.dataset, ["forces", name], T_END, RATE)


@pytest.mark.parametrize("name", ["transmission_error", "spectrum:mesh_force:lsp.sun_planet.1"])
def test_runs_too_short_are_refused_before_any(result, name):
    with pytest.raises(LtcgearError, match=re.escape(f"--metric {name}: the second half of a run has 41 samples")):
        lay_out(result.dataset, [name], 0.01, RATE)
    assert "energy_residual" in lay_out(result.dataset, ["energy_residual"], 1 / RATE, RATE)


def test_rows_of_variants_fit_one_form(row):
    """What one variant has and another has not is NaN; no label is lost or moved."""
    fewer = row.sel(mesh=row["mesh"].values[:3]).drop_vars("energy_residual")
    other = row.assign_coords(pin=[f"x.pin.{k}" for k in range(4)])
    form = unite([fewer, row, other])
    assert list(form["mesh"].values) == list(row["mesh"].values)
    assert list(form["pin"].values) == [*row["pin"].values, *other["pin"].values]
    again = fewer.reindex_like(form)
    assert np.array_equal(again["load_factor"].values[:3], row["load_factor"].values[:3])
    assert np.isnan(again["load_factor"].values[3:]).all()
    assert set(form.data_vars) == set(row.data_vars)
