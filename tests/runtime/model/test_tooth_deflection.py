"""Deflections that no tooth can give are told, and refused beyond a tooth; machines past their breakdown are told."""

import numpy as np
import pytest
from ltcgear.generated.errors import SolverError
from ltcgear.runtime.model.equilibrium import find_equilibrium
from ltcgear.runtime.model.tooth_deflection import STRAINED, Teeth
from ltcgear.runtime.simulation.recording import record
from ltcgear.runtime.simulation.simulate import simulate

from ..models import case

OPTIONS = {"t_end": 0.02, "rate": 4096.0, "method": "erk"}
LOAD, SPEED = "loads.output.torque_over_time", "loads.input.speed_over_time"


def softened(c, factor):
    values = c.model.values()
    return values | {name: values[name] * factor for name in values if "mesh.stiffness" in name}


def test_the_base_pitch_is_that_of_the_teeth_or_that_of_the_fewest_there_are():
    c = case("psh")
    teeth, values = Teeth(c.library, c.p), c.model.values()
    assert teeth.meshes == ("psh.mesh",)
    scene = c.scene.stages["psh"]
    normal = scene.module * np.cos(scene.pressure_angle)
    assert teeth.pitch == pytest.approx([np.pi * normal], rel=0.02)  # the normal section's, but for the helix
    assert teeth.pitch == pytest.approx([2 * np.pi * values["psh.mesh.base_radius_1"] / 59])
    unknown = case("lin-parker-3")
    smallest = 2 * np.pi * unknown.model.values()["gear.sun_planet.base_radius_1"] / 3
    assert Teeth(unknown.library, unknown.p).pitch[0] == pytest.approx(smallest)
    assert Teeth(unknown.library, unknown.p).known is False


def test_a_load_that_bends_the_teeth_by_more_than_a_tooth_is_refused_before_anything_is_integrated():
    c = case("psh")
    values = softened(c, 1e-3)
    for begin in (
        lambda: simulate(c.library, values, **OPTIONS),
        lambda: find_equilibrium(c.library, c.library.parameters(values)),  # where modes and all else begin
    ):
        with pytest.raises(SolverError, match=r"psh\.mesh: .* deflection of 0\.0\d+ m, above half of the base pitch"):
            begin()


def test_teeth_that_bend_like_rubber_are_told():
    c = case("psh")
    warned = simulate(c.library, softened(c, 1 / 20), **OPTIONS)
    deepest = warned.dataset["mesh_deflection"].max().item()
    assert deepest > STRAINED * Teeth(c.library, c.p).pitch[0]
    assert warned.summary["status"] == "done"
    assert [text for text in warned.summary["warnings"] if text.startswith("psh.mesh: deflects by up to 0.0")]
    assert simulate(c.library, c.model.values(), **OPTIONS).summary["warnings"] == []


@pytest.mark.parametrize("raw", [False, True])
def test_a_run_that_goes_through_a_tooth_is_not_to_be_used(tmp_path, raw):
    """The load rises to two thousand times what it begins with, and falls again before the half that is looked at."""
    c = case("hard-dead-band")
    (_, torque), *_ = c.model.tables[LOAD]
    tables = {
        SPEED: [(0.0, 100.0)],
        LOAD: [(0.0, torque), (0.004, torque), (0.005, 2000 * torque), (0.006, torque)],
    }
    found = simulate(c.library, c.model.values(), tables=tables, raw=raw, **OPTIONS)
    status = found.summary["status"]
    assert "pair.mesh: " in status
    assert "above half of the base pitch, 0.00443 m" in status
    assert "not to be used" in status
    assert found.summary["forces"] == {}
    assert found.dataset.sizes["time"] == 83  # what was computed is kept
    summary = record(c.library, c.model.values(), tmp_path / "a.nc", tables=tables, raw=raw, **OPTIONS)
    assert summary["status"] == status


def test_a_machine_that_is_past_its_breakdown_slip_at_the_end_is_told():
    c = case("start-up")
    values, synchronous = c.model.values(), c.model.values()["loads.generator.synchronous_speed"]
    ratio = values["generator.speed_ratio"]

    def warnings(slip):
        """Of a run at a slip, over breakdown slip."""
        speed = (synchronous + slip * values["loads.generator.breakdown_slip_speed"]) / ratio
        tables = dict(c.model.tables) | {"loads.motor.speed_over_time": [(0.0, speed)]}
        found = simulate(c.library, values, tables=tables, **OPTIONS)
        return [text for text in found.summary["warnings"] if "breakdown" in text]

    assert warnings(0.8) == warnings(-0.8) == []
    for slip in (1.5, -1.5):
        (text,) = warnings(slip)
        assert text.startswith("loads.generator: ")
        assert float(text.partition(" times its breakdown slip")[0].rpartition(" ")[2]) == pytest.approx(1.5, rel=0.02)


def test_an_error_of_two_modules_is_not_believed_and_a_smaller_one_is_told():
    c = case("hard-dead-band")

    def run(error):
        changed = c.model.values() | {"pair.mesh.transmission_error_cos_1": error}
        return simulate(c.library, changed, tables=c.model.tables, **OPTIONS | {"t_end": 0.05}).summary

    assert "not to be used" in run(2 * c.scene.stages["pair"].module)["status"]
    told = run(0.2 * c.scene.stages["pair"].module)
    assert told["status"] == "done"
    assert any(text.startswith("pair.mesh: deflects by up to") for text in told["warnings"])
