"""Loads over time and the slip law in scenes: what is read, what is refused, which motion and statics follow."""

import pytest
from ltcgear.generated.errors import SceneError
from ltcgear.symbolic.describe.geometry_report import describe, load_warnings
from ltcgear.symbolic.gears import train
from ltcgear.symbolic.scene.load import load_scene, make_scene, restore_scene

RPM = 0.10471975511965977
SLIP = {"synchronous_speed": "-100 rad/s", "breakdown_torque": "500 N*m", "breakdown_slip": 0.1}
RAMP = [["0 s", "0 rpm"], ["1 s", "30 rpm"], ["2 s", "60 rpm"]]
SCENE = """
title = "pair"

[stages.gear]
kind = "pair"
module = "4 mm"
pressure_angle = "20 deg"
input = { teeth = 20, support = "rigid", inertia = "0.01 kg*m^2" }
output = { teeth = 40, support = "rigid", inertia = "0.1 kg*m^2" }
mesh = { stiffness = "5e8 N/m" }
"""


def pair(**loads):
    return {
        "title": "pair",
        "stages": {
            "gear": {
                "kind": "pair",
                "module": "4 mm",
                "pressure_angle": "20 deg",
                "input": {"teeth": 20, "support": "rigid", "inertia": "0.01 kg*m^2"},
                "output": {"teeth": 40, "support": "rigid", "inertia": "0.1 kg*m^2"},
                "mesh": {"stiffness": "5e8 N/m"},
            }
        },
        "loads": loads,
    }


def on(member, **keys):
    return {"member": f"gear.{member}", **keys}


def refusal(raw):
    with pytest.raises(SceneError) as caught:
        make_scene(raw)
    return str(caught.value)


def test_a_table_beside_the_scene_file_is_read_and_kept(tmp_path):
    text = SCENE + '[loads.drive]\nmember = "gear.input"\nspeed_over_time = "ramp.csv"\n'
    (tmp_path / "gear.toml").write_text(text, encoding="utf-8")
    (tmp_path / "ramp.csv").write_text("time [min],speed [rpm]\n0,0\n0.5,60\n", encoding="utf-8")
    scene = load_scene(tmp_path / "gear.toml")
    assert scene.loads["drive"].speed_over_time == ((0.0, 0.0), (30.0, pytest.approx(60 * RPM)))
    (tmp_path / "ramp.csv").unlink()
    assert restore_scene(scene.model_dump_json()) == scene
    with pytest.raises(SceneError, match=r"loads\.drive\.speed_over_time: 'ramp\.csv': no such file"):
        load_scene(tmp_path / "gear.toml")


def test_a_fault_in_a_table_tells_the_load_and_the_row():
    told = refusal(pair(drive=on("input", speed_over_time=[["0 s", "0 rpm"], ["0 s", "1 rpm"]])))
    assert "  loads.drive.speed_over_time: row 2: the first column must ascend" in told


FAULTS = {
    "two kinds": (
        pair(a=on("input", speed="1 rpm", slip=SLIP)),
        "loads.a: give either speed or torque, one of speed, ",
    ),
    "no kind": (pair(a=on("input")), "loads.a: give either speed or torque"),
    "start of a held speed": (
        pair(a=on("input", speed_over_time=RAMP, initial_speed="1 rpm")),
        "loads.a.initial_speed: goes with torque",
    ),
    "no motion": (
        pair(a=on("input", speed_over_time=[["0 s", "0 rpm"], ["1 s", "0 rpm"]])),
        'loads.a.speed_over_time: is zero throughout; write speed = "0 rpm"',
    ),
    "motion over at the start": (
        pair(a=on("input", speed_over_time=[["-2 s", "1 rpm"], ["-1 s", "0 rpm"]])),
        "loads: the speed over time of gear.input is zero from the start on",
    ),
    "start of another member": (
        pair(a=on("input", speed_over_time=RAMP), b=on("output", torque="1 N*m", initial_speed="0 rpm")),
        "loads.b.initial_speed: the start follows from the speed over time of gear.input; drop it",
    ),
    "a constant speed beside": (
        pair(a=on("input", speed_over_time=RAMP), b=on("output", speed="-15 rpm")),
        "loads.b.speed: beside gear.input with its speed over time it must be zero",
    ),
    "another course beside": (
        pair(a=on("input", speed_over_time=RAMP), b=on("output", speed_over_time=RAMP[:2])),
        "loads.b.speed_over_time: must be that of gear.input times a constant",
    ),
    "a ratio that teeth forbid": (
        pair(a=on("input", speed_over_time=RAMP), b=on("output", speed_over_time=RAMP)),
        "loads: the speeds contradict the teeth",
    ),
    "no synchronous speed": (
        pair(a=on("input", slip=SLIP | {"synchronous_speed": "0 rpm"})),
        "loads.a.slip.synchronous_speed: must not be zero",
    ),
    "slip in words": (pair(a=on("input", slip=SLIP | {"breakdown_slip": "10 %"})), "loads.a.slip.breakdown_slip: must"),
    "negative breakdown": (
        pair(a=on("input", slip=SLIP | {"breakdown_torque": "-5 N*m"})),
        "loads.a.slip.breakdown_torque: '-5 N*m' must be greater than zero",
    ),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_loads_that_do_not_work_are_refused(fault):
    raw, told = FAULTS[fault]
    assert told in refusal(raw)


@pytest.mark.parametrize(
    ("rows", "chief"),
    [
        ([["0 s", "5 rpm"], ["1 s", "30 rpm"]], 5),
        ([["-1 s", "10 rpm"], ["1 s", "30 rpm"]], 20),
        ([["2 s", "5 rpm"], ["3 s", "-30 rpm"]], 5),
        (RAMP, 60),
        ([["0 s", "0 rpm"], ["1 s", "-20 rpm"], ["2 s", "-10 rpm"], ["3 s", "0 rpm"], ["4 s", "90 rpm"]], -20),
        ([["-9 s", "40 rpm"], ["-1 s", "0 rpm"], ["1 s", "0 rpm"], ["2 s", "-7 rpm"]], -7),
    ],
)
def test_the_reference_speed_is_that_at_the_start_or_of_the_run_up(rows, chief):
    motion, faults = train.motion(make_scene(pair(a=on("input", speed_over_time=rows))))
    assert not faults
    assert motion.mode == "speed"
    assert motion.speed == pytest.approx(chief * RPM)
    assert motion.ratios["gear.output"] == pytest.approx(-0.5)


def test_a_fixed_ratio_of_two_speeds_over_time_is_allowed():
    half = [["0 s", "0 rpm"], ["1 s", "-15 rpm"], ["2 s", "-30 rpm"]]
    motion, faults = train.motion(
        make_scene(pair(a=on("input", speed_over_time=RAMP), b=on("output", speed_over_time=half)))
    )
    assert not faults
    assert motion.ratios["gear.output"] == pytest.approx(-0.5)


def test_statics_take_the_largest_torque():
    rows = [["0 s", "3 N*m"], ["1 s", "-80 N*m"], ["2 s", "50 N*m"]]
    varying, constant = (
        make_scene(pair(a=on("input", speed="60 rpm"), b=on("output", **load)))
        for load in ({"torque_over_time": rows}, {"torque": "-80 N*m"})
    )
    one, two = (train.static_forces(scene, train.motion(scene)[0]) for scene in (varying, constant))
    assert one == two
    assert one["gear.mesh"] != 0


@pytest.mark.parametrize(("speed", "torque"), [("-110 rad/s", 500.0), ("-90 rad/s", -500.0), ("-100 rad/s", 0.0)])
def test_statics_take_the_slip_law_at_the_rigid_speed(speed, torque):
    scene = make_scene(pair(a=on("output", speed=speed), b=on("output", slip=SLIP)))
    assert describe(scene)["loads"]["b"]["torque_n_m"] == pytest.approx(torque)


def test_info_tells_how_loads_vary():
    rows = [["0 s", "3 N*m"], ["1 s", "-80 N*m"]]
    scene = make_scene(pair(a=on("input", speed_over_time=RAMP), b=on("output", torque_over_time=rows),
                            c=on("output", slip=SLIP)))  # fmt: skip
    loads = describe(scene)["loads"]
    assert loads["a"]["law"] == "0 to 60 r/min over time, from 0 to 2 s in 3 rows"
    assert loads["b"]["law"] == "-80 to 3 N m over time, from 0 to 1 s in 2 rows"
    assert loads["c"]["law"] == "slip law: -954.93 r/min synchronous, breakdown 500 N m at slip 0.1"
    assert loads["b"]["torque_n_m"] == -80
    assert loads["a"]["power_kw"] == pytest.approx(-loads["b"]["power_kw"] - loads["c"]["power_kw"])
    assert not load_warnings(scene)
