"""The paper's rig over one turn of its input: what the issue of lossless means calls for."""

from functools import cache

import pytest
from ltcgear.runtime.results.statistics import mesh_frequencies, statistics
from ltcgear.runtime.simulation.simulate import simulate

from ..models import case


@cache
def turn():
    """Simulate one turn of the LSP ring, 4 s at 15 rpm."""
    rig = case("rig-2mw")
    return simulate(rig.library, rig.model.values(), t_end=4.0, rate=8192.0).dataset


@pytest.mark.parametrize(("stage", "printed"), [("lsp", 29.500), ("hsp", 158.227), ("psh", 628.255)])
def test_mesh_frequencies_over_a_whole_turn(stage, printed):
    assert mesh_frequencies(turn(), 0.0)[stage] == pytest.approx(printed, abs=1e-3)


@pytest.mark.parametrize(
    ("mesh", "statics"),
    [("lsp.sun_planet.1", 3.575e5), ("lsp.ring_planet.3", 3.575e5), ("hsp.sun_planet.2", 1.0357e5),
     ("hsp.ring_planet.1", 1.0357e5), ("psh.mesh", 1.1834e5)],
)  # fmt: skip
def test_mean_normal_forces_of_the_lossless_rig_are_those_of_statics(mesh, statics):
    """READING.md: torque over base radius, shared by the planets."""
    assert statistics(turn(), 2.0)[mesh]["mean"] == pytest.approx(statics, rel=5e-3)


def test_the_drive_gives_what_the_generator_takes():
    """The overall ratio is 118/22 (1 + 118/17) 59/21 = 119.668, both shafts turning alike."""
    data = turn()
    assert float(data["drive_torque"].mean()) == pytest.approx(1.06e4 * 119.66769, rel=2e-3)
    speeds = data["speed"].mean("time")
    assert float(speeds.sel(rotor="generator") / speeds.sel(rotor="motor")) == pytest.approx(119.668, rel=1e-4)
