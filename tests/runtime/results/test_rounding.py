"""What of a result is rounding: trains at rest, members that symmetry holds, forces that only the tolerance varies."""

import numpy as np
import pytest
from ltcgear.runtime.analysis import analyse, find_spectrum, name_lines
from ltcgear.runtime.analysis.lines import Clues
from ltcgear.runtime.results.rounding import is_unstrained, round_statistics, without_rounding
from ltcgear.runtime.results.statistics import statistics
from ltcgear.runtime.view import list_tables

from ..outputs import result, times

TIME = times(0.25)
NOISE = np.random.default_rng(2).normal(size=TIME.size)
STIFFNESS = 5e8


def train(force, static=0.0, speed=0.0, **more):
    """A pair with a mesh force [N], the deflection that belongs to it, and what else there is."""
    quantities = {"mesh_force": {"a.mesh": force}, "mesh_deflection": {"a.mesh": np.asarray(force) / STIFFNESS}}
    more = {"speed": {"a.input": speed}} | more
    found = result(TIME, {"a.input.mass": 2.0}, mesh_phase={"a.mesh": 30.0 * TIME}, **quantities, **more)
    return found.assign_attrs(static_strain_j=static)


@pytest.mark.parametrize(("size", "static", "unstrained"), [(0.1, 0.0, True), (0.1, 1e-3, False), (30.0, 0.0, False)])
def test_a_train_is_unstrained_where_nothing_stores_energy(size, static, unstrained):
    """1e-9 J: 1 N at 5e8 N/m. One that is loaded at its start, or at any time, is not."""
    assert is_unstrained(train(size * np.sin(40.0 * TIME), static)) == unstrained


def test_results_that_do_not_tell_are_not_unstrained():
    assert not is_unstrained(train(0.0).drop_vars("mesh_deflection"))
    bare = train(0.0)
    del bare.attrs["static_strain_j"]
    assert not is_unstrained(bare)


def test_a_train_at_rest_has_no_force_no_factor_and_no_line():
    """What the issue of rounding is: 0.1 N, of which the mean is nearly nothing, and a motion of nanometres."""
    noisy = train(0.1 * NOISE, acceleration_x={"a.input": 1e-2 * NOISE}, twist={"a.input": 1e-9 * NOISE})
    found = analyse(noisy)
    assert found.forces["a.mesh"] == pytest.approx(
        {"mean": 0.0, "min": 0.0, "max": 0.0, "rms": 0.0, "amplitude": 0.0, "load_factor": np.nan}, nan_ok=True
    )
    assert "lines-mesh_force" not in list_tables(found)
    assert np.isnan(list_tables(found)["forces"].rows[0][-2])
    clean = without_rounding(noisy)
    assert not any(np.any(clean[name]) for name in ("mesh_force", "mesh_deflection", "acceleration_x", "twist"))
    assert np.any(noisy["mesh_force"])  # the result stays as it is


def test_an_unstrained_train_that_turns_keeps_its_motion():
    turning = without_rounding(train(0.1 * NOISE, speed=30.0, displacement_x={"a.input": 1e-3 * NOISE}))
    assert not np.any(turning["mesh_force"])
    assert np.all(turning["speed"] == 30.0)
    assert np.any(turning["displacement_x"])


def test_what_is_faint_beside_its_kind_is_nothing():
    """Forces of all kinds are weighed against the largest of them."""
    force = 2e3 + 100.0 * np.sin(190.0 * TIME)
    bearings = {"still": 1e-8 * NOISE, "loaded": force, "faint": 1e-3 * np.sin(50.0 * TIME)}
    found = without_rounding(train(force, 1e-2, 30.0, bearing_force_x=bearings))
    assert np.abs(found["bearing_force_x"]).max("time").values.tolist() == pytest.approx(
        [0.0, force.max(), 1e-3], rel=1e-4
    )
    np.testing.assert_array_equal(found["mesh_force"].values[:, 0], force)


def test_an_acceleration_is_weighed_against_what_forces_give_to_the_mass():
    """With constant forces the largest acceleration is rounding too: 1e-6 of 2 kN at 2 kg are 1e-3 m/s^2."""
    for size, kept in ((5e-4, False), (5e-3, True)):
        found = without_rounding(train(2e3, 1e-2, 30.0, acceleration_x={"a.input": size * np.sin(40.0 * TIME)}))
        assert bool(np.any(found["acceleration_x"])) == kept


def test_a_force_that_only_the_tolerance_varies_is_constant():
    for ripple, lines in ((1e-7, 0), (1e-4, 1)):
        force = 2e3 * (1.0 + ripple * np.sin(2.0 * np.pi * 200.0 * TIME))
        clean = without_rounding(train(force, 1e-2, 30.0))
        spectrum = find_spectrum(clean["mesh_force"].sel(mesh="a.mesh"))
        assert len(name_lines(spectrum, Clues(), 1)) == lines
        assert float(clean["mesh_force"].mean()) == pytest.approx(2e3, rel=1e-6)


def test_statistics_of_an_idle_mesh_have_no_factor():
    run = train(2e3 + 5.0 * NOISE, 1e-2, 30.0)
    told = statistics(run, 0.0)
    idle = dict.fromkeys(("mean", "min", "max", "rms", "amplitude"), 1e-8) | {"load_factor": 40.0}
    found = round_statistics(told | {"b.mesh": idle}, run)
    assert found["a.mesh"] == told["a.mesh"]
    assert found["b.mesh"].pop("load_factor") != 40.0
    assert set(found["b.mesh"].values()) == {0.0}


def test_samples_that_are_no_numbers_stay():
    broken = train(np.where(TIME < 0.1, 2e3, np.nan), 1e-2, 30.0)
    np.testing.assert_array_equal(without_rounding(broken)["mesh_force"], broken["mesh_force"])


def test_statistics_along_the_motion_are_rounded_as_samples_are():
    """They tell whether a train is strained where no sample is held."""
    values = np.array([[0.0, 0.0, 0.0], [0.1, 2e-10, 9.0], [0.1, 2e-10, 9.0], [-0.1, -2e-10, 9.0], [0.1, 2e-10, 9.0]])
    labels = {"statistic": ["mean", "rms", "std", "min", "max"],
              "output": ["mesh_force:a.mesh", "mesh_deflection:a.mesh", "speed:a.input"]}  # fmt: skip
    run = train(0.1 * np.sin(40.0 * TIME), speed=9.0).assign(statistics=(tuple(labels), values)).assign_coords(labels)
    run = run.assign_coords(output_unit=("output", ["N", "m", "rad/s"]))
    assert without_rounding(run)["statistics"].sel(statistic="max").values.tolist() == [0.0, 2e-10, 9.0]
    heading = run.isel(time=slice(0))
    assert is_unstrained(heading)
    told = round_statistics({"a.mesh": {"mean": 1e-4, "min": -0.1, "max": 0.1, "load_factor": 1e3}}, heading)
    assert told["a.mesh"]["max"] == 0.0
    assert np.isnan(told["a.mesh"]["load_factor"])
