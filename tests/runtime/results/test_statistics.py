import numpy as np
import pytest
from ltcgear.runtime.results.statistics import (
    mesh_frequencies,
    pressure_angles,
    sampling_rate,
    shaft_speeds,
    statistics,
    steady_start,
    window,
)

from ..synthetic import ALPHA, HSP, LSP, PSH, RATE, SPEEDS, STEADY, make_dataset


@pytest.fixture(scope="module")
def dataset():
    return make_dataset()


def test_statistics_of_a_sine(dataset):
    found = statistics(dataset, STEADY)["lsp.sun_planet.2"]
    assert found["mean"] == pytest.approx(3.5e5, rel=1e-4)
    assert found["min"] == pytest.approx(3.0e5, rel=1e-4)
    assert found["max"] == pytest.approx(4.0e5, rel=1e-4)
    assert found["amplitude"] == pytest.approx(0.5e5, rel=1e-3)
    assert found["rms"] == pytest.approx(np.sqrt(3.5**2 + 0.5**2 / 2) * 1e5, rel=1e-4)
    assert found["load_factor"] == pytest.approx(4.0 / 3.5, rel=1e-4)


def test_every_mesh_has_statistics(dataset):
    assert list(statistics(dataset, STEADY)) == [str(mesh) for mesh in dataset["mesh"].values]


def test_the_other_flank_has_a_positive_load_factor(dataset):
    found = statistics(dataset, STEADY)["psh.mesh"]
    assert found["mean"] == pytest.approx(-1.2e5, rel=1e-4)
    assert found["load_factor"] == pytest.approx(1.25, rel=1e-4)


def test_the_transient_counts_only_when_asked_for(dataset):
    assert statistics(dataset, 0.0)["psh.mesh"]["amplitude"] > 2e5


def test_an_unloaded_mesh_has_no_load_factor(dataset):
    idle = dataset.assign(mesh_force=dataset["mesh_force"] * 0.0)
    assert np.isnan(statistics(idle, STEADY)["psh.mesh"]["load_factor"])


def test_a_start_after_the_end_is_refused(dataset):
    with pytest.raises(ValueError, match="choose an earlier start"):
        statistics(dataset, 9.0)


def test_mesh_frequencies_are_the_phase_slopes(dataset):
    assert mesh_frequencies(dataset) == pytest.approx({"lsp": LSP, "hsp": HSP, "psh": PSH}, rel=1e-9)


def test_mesh_frequencies_of_a_window(dataset):
    time = dataset["time"]
    bent = dataset.assign(mesh_phase=dataset["mesh_phase"] + 5.0 * (time - 3.0).clip(min=0.0))
    assert mesh_frequencies(bent, 0.0, 3.0)["psh"] == pytest.approx(PSH)
    assert mesh_frequencies(bent, 3.0)["psh"] == pytest.approx(PSH + 5.0)


def test_shaft_speeds_are_signed_means(dataset):
    ripple = np.sin(2 * np.pi * 8.0 * dataset["time"])
    found = shaft_speeds(dataset.assign(speed=dataset["speed"] + ripple))
    assert found == pytest.approx(SPEEDS, abs=1e-3)


def test_pressure_angles(dataset):
    assert pressure_angles(dataset) == {}
    known = make_dataset(pressure_angle=True)
    assert pressure_angles(known)["psh.mesh"] == pytest.approx(ALPHA)
    wobble = 0.01 * np.sin(2 * np.pi * known["time"])
    moving = known.assign(pressure_angle=known["pressure_angle"] + wobble)
    assert pressure_angles(moving)["lsp.sun_planet.1"] == pytest.approx(ALPHA, abs=1e-5)


def test_windows(dataset):
    assert steady_start(dataset) == pytest.approx(STEADY, abs=1.0 / RATE)
    assert sampling_rate(dataset) == pytest.approx(RATE)
    part = window(dataset, 1.0, 1.5)["time"].values
    assert part[0] == 1.0
    assert part[-1] == 1.5
