"""Band-limited results and statistics along the motion: against finer rates, statics, and the choice of a rate."""

import numpy as np
import pytest
from ltcgear.runtime import build, simulate
from ltcgear.runtime.results.amplitude_spectrum import amplitude_spectrum, strongest_lines
from ltcgear.runtime.results.statistics import window
from ltcgear.runtime.simulation.low_pass import BAND
from ltcgear.runtime.simulation.sampling_rate import HARMONICS, LEAST, choose_rate, mesh_frequency
from ltcgear.symbolic import build_model, load_scene
from ltcgear.symbolic.emit.pipeline import obtain

from ..models import case

FINER = 32
HOIST = """
title = "Pair whose mesh frequency is 2048 Hz"
[stages.first]
kind = "pair"
module = "4 mm"
pressure_angle = "20 deg"
mesh = { stiffness = "7e8 N/m", double_factor = 1.4, damping_ratio = 0.05 }
[stages.first.input]
teeth = 32
support = "bearing"
bearing = { stiffness = "8e8 N/m", damping_ratio = 0.03 }
disc = { outer_diameter = "128 mm", width = "60 mm" }
[stages.first.output]
teeth = 71
support = "bearing"
bearing = { stiffness = "9e8 N/m", damping_ratio = 0.03 }
disc = { outer_diameter = "284 mm", width = "55 mm" }
[loads.motor]
member = "first.input"
speed = "3840 rpm"
[loads.drum]
member = "first.output"
torque = "1100 N*m"
"""

SHAFT = """
title = "Shaft under a torque over time"
[rotors.one]
inertia = "2 kg*m^2"
[rotors.two]
inertia = "3 kg*m^2"
[couplings.shaft]
between = ["one", "two"]
stiffness = "2e4 N*m/rad"
damping_ratio = 0.05
[loads.one]
member = "one"
torque_over_time = [["0 s", "1 N*m"], ["0.3 s", "200 N*m"]]
initial_speed = "10 rpm"
"""


@pytest.fixture(scope="module")
def hoist(tmp_path_factory):
    file = tmp_path_factory.mktemp("scenes") / "hoist.toml"
    file.write_text(HOIST)
    model = build_model(load_scene(file))
    return build(obtain(model)), model.values()


def lines_of(result, mesh, rate):
    """Ten strongest lines of a mesh force in the band of a rate, over the same time whatever the result's own."""
    half = window(result.dataset)["mesh_force"].sel(mesh=mesh).values
    count = (half.size - 1) // round(result.summary["rate_hz"] / rate) * round(result.summary["rate_hz"] / rate)
    frequency, amplitude = amplitude_spectrum(half[-count - 1 : -1], result.summary["rate_hz"])
    inside = frequency <= BAND * rate
    return frequency[1], strongest_lines(frequency[inside], amplitude[inside], 10, 2 * frequency[1])


OUT = 'effects.tooth_errors = "on"', 'stages.psh.mesh.tooth_errors = [{ gear = "input", tooth = 3, error = "20 um" }]'


@pytest.mark.parametrize("scene", [("lsp",), ("psh",), ("psh", *OUT)], ids=["lsp", "psh", "one tooth out"])
def test_the_strongest_lines_are_those_of_a_far_finer_rate(scene):
    c, rate = case(*scene), 4096.0
    options = {"t_end": 0.25, "method": "erk", "tables": c.model.tables}
    coarse, fine = (simulate(c.library, c.model.values(), rate=each, **options) for each in (rate, FINER * rate))
    assert coarse.dataset.attrs["band_hz"] == coarse.summary["band_hz"] == BAND * rate
    for mesh in coarse.dataset["mesh"].values:
        (bin_hz, lines), (_, wanted) = lines_of(coarse, mesh, rate), lines_of(fine, mesh, rate)
        for line in lines:
            near = min(wanted, key=lambda other, at=line.frequency_hz: abs(other.frequency_hz - at))
            assert abs(near.frequency_hz - line.frequency_hz) < 1.01 * bin_hz
            assert line.amplitude == pytest.approx(near.amplitude, rel=5e-3)


def test_raw_samples_show_lines_that_are_not_there(hoist):
    library, values = hoist
    raw, fine = (simulate(library, values, t_end=0.5, rate=rate, raw=rate < 1e5) for rate in (5000.0, 160_000.0))
    assert "band_hz" not in raw.dataset.attrs
    assert "band_hz" not in raw.summary
    true, shown = (lines_of(one, "first.mesh", 5000.0)[1][0] for one in (fine, raw))
    assert shown.amplitude > 1.5 * true.amplitude


@pytest.mark.parametrize("rate", [4096.0, 5000.0, 8192.0, 30_000.0])
def test_means_are_those_of_statics_at_any_rate(hoist, rate):
    """Two samples a mesh period, four, and none in step: torque over the base radius."""
    library, values = hoist
    found = simulate(library, values, t_end=1.0, rate=rate)
    force, output = found.summary["forces"]["first.mesh"], found.statistics["mesh_force:first.mesh"]
    statics = 1100.0 / values["first.mesh.base_radius_2"]
    assert force["mean"] == output["mean"] == pytest.approx(statics, rel=1e-6)
    assert force["load_factor"] == pytest.approx(force["max"] / force["mean"], rel=1e-14)
    # What samples of the instant would say: four of them a period see four phases only.
    if rate == 8192.0:
        raw = simulate(library, values, t_end=1.0, rate=rate, raw=True)
        assert abs(float(window(raw.dataset)["mesh_force"].mean()) / statics - 1) > 1e-3
        assert raw.summary["forces"]["first.mesh"]["mean"] == pytest.approx(statics, rel=1e-6)


def test_over_speeds_that_meet_the_rate_statistics_are_smooth(hoist):
    library, values = hoist
    speeds = np.linspace(3700.0, 3980.0, 15)
    rms, factor = [], []
    for speed in speeds:
        changed = values | {"reference.speed": speed * np.pi / 30}
        force = simulate(library, changed, t_end=0.3, rate=8192.0).summary["forces"]["first.mesh"]
        assert force["mean"] == pytest.approx(1100.0 / values["first.mesh.base_radius_2"], rel=1e-6)
        rms.append(force["rms"])
        factor.append(force["load_factor"])
    for course in (np.array(rms), np.array(factor)):
        bends = np.abs(np.diff(course, 2))
        assert bends.max() < 0.2 * np.ptp(course)  # 3840 r/min is the eighth of them


def test_a_rate_is_chosen_by_modes_and_meshes(hoist):
    library, values = hoist
    found = simulate(library, values, t_end=0.1)
    rate, band = found.summary["rate_hz"], found.summary["band_hz"]
    assert np.log2(rate) % 1 == 0
    assert band == BAND * rate
    assert band > HARMONICS * 2048.0
    assert "2048 Hz" in found.summary["why_rate"]
    assert simulate(library, values, t_end=0.1, rate=8192.0).summary["why_rate"] is None
    slow = values | {"reference.speed": values["reference.speed"] / 1000}
    assert simulate(library, slow, t_end=0.1).summary["rate_hz"] <= rate


def test_the_rate_of_a_run_up_is_that_of_its_highest_speed():
    ramp = "-loads.input.speed", 'loads.input.speed_over_time = [["0 s", "0 rpm"], ["0.1 s", "900 rpm"]]'
    still, turning = case("psh", *ramp), case("psh", 'loads.input.speed = "900 rpm"')
    found = [mesh_frequency(c.point, c.model.tables) for c in (still, turning)]
    assert found[0] == pytest.approx(found[1], rel=1e-12)
    assert choose_rate(still.point, still.model.tables).rate >= LEAST


def test_statistics_of_a_short_slow_run_do_not_hang_on_its_few_arcs(tmp_path):
    """A single arc holds the run; its points resolve the weights all the same, raw samples or not."""
    file = tmp_path / "shaft.toml"
    file.write_text(SHAFT)
    model = build_model(load_scene(file))
    library, values = build(obtain(model)), model.values()
    options = {"t_end": 0.02, "tables": model.tables}
    dense = simulate(library, values, rate=2e5, raw=True, **options).dataset["coupling_torque"].values[2000:, 0]
    wanted = np.average(dense, weights=np.sin(np.linspace(0, np.pi, dense.size)) ** 4)
    for raw in (True, False):
        found = simulate(library, values, rate=1e3, raw=raw, **options)
        assert found.summary["counts"]["segments"] == 1
        assert found.statistics["coupling_torque:shaft"]["mean"] == pytest.approx(wanted, rel=1e-4)
