"""Loads that are one number become tables that are constant, and the motion stays what it was."""

import numpy as np
import pytest
from ltcgear.runtime import build, simulate
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.emit.pipeline import obtain
from ltcgear.symbolic.scene.load import load_scene
from ltcgear.symbolic.scene.steering import steer_loads


def test_numbers_become_tables():
    scene, tables = steer_loads(load_scene("psh"))
    assert tables == ("loads.input.speed_over_time", "loads.output.torque_over_time")
    assert scene.loads["output"].torque is None
    assert {value for _, value in scene.loads["output"].torque_over_time} == {-1.06e4}
    model = build_model(scene)
    assert [signal.name for signal in model.signals] == [
        "reference.speed", "reference.acceleration", "loads.output.torque",
    ]  # fmt: skip


def test_tables_stay_and_so_do_speeds_of_zero():
    assert steer_loads(load_scene("start-up"))[1] == ()
    scene, tables = steer_loads(load_scene("psh", {"loads.input.speed": "0 rpm"}))
    assert tables == ("loads.output.torque_over_time",)
    assert scene.loads["input"].speed == 0


def test_the_motion_is_the_same():
    scene = load_scene("psh")
    forces = []
    for each in (scene, steer_loads(scene)[0]):
        model = build_model(each)
        options = {"t_end": 0.02, "rate": 8192, "rtol": 1e-9, "tables": model.tables, "method": "erk"}
        forces.append(simulate(build(obtain(model)), model.values(), **options).dataset["mesh_force"].values)
    assert np.abs(forces[0]).mean() > 1e4
    assert forces[1] == pytest.approx(forces[0], rel=1e-6)
