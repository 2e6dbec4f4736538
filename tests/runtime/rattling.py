"""A pair whose teeth part and meet again, with inputs: what the tests of FMUs simulate."""

from dataclasses import dataclass

from ltcgear.runtime import build, simulate, write_fmu
from ltcgear.runtime.model.library import Library
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.emit.pipeline import obtain
from ltcgear.symbolic.scene.load import load_scene
from ltcgear.symbolic.scene.steering import steer_loads

SCENE = """
title = "Two gears that rattle"
effects = { contact = "backlash", lateral = "off", transmission_error = "on" }

[stages.pair]
kind = "pair"
module = "4 mm"
pressure_angle = "20 deg"

[stages.pair.input]
teeth = 31
mass = "4 kg"
inertia = "0.01 kg*m^2"
support = "bearing"
bearing.stiffness = "1e9 N/m"

[stages.pair.output]
teeth = 43
mass = "8 kg"
inertia = "0.04 kg*m^2"
support = "bearing"
bearing.stiffness = "1e9 N/m"

[stages.pair.mesh]
stiffness = "2e8 N/m"
double_factor = 1.3
damping_ratio = 0.05
contact_ratio = 1.6
backlash = "100 um"
transmission_error = { amplitudes = ["10 um"] }

[loads.motor]
member = "pair.input"
speed = "1490 rpm"

[loads.brake]
member = "pair.output"
torque = "-150 N*m"

[simulation]
t_end = "0.02 s"
rate = "20 kHz"
"""
T_END, RATE = 0.02, 20e3
SAMPLES = round(T_END * RATE)
SPEED, TORQUE = "loads.motor.speed_over_time", "loads.brake.torque_over_time"


@dataclass
class Steered:
    """A scene whose constant loads are tables, ready to simulate and to be written as an FMU."""

    name: str
    library: Library
    values: dict[str, float]
    tables: dict
    inputs: tuple[str, ...]
    title: str = ""

    def simulate(self, changes=None, tables=None, rtol=1e-9, t_end=T_END, rate=RATE):
        """Simulate with other parameters or tables; samples are those of the instant, as an FMU's are."""
        values, led = self.values | (changes or {}), self.tables | (tables or {})
        return simulate(self.library, values, t_end=t_end, rate=rate, rtol=rtol, tables=led, method="erk", raw=True)

    def write(self, path, kind="co-simulation", t_end=T_END, rate=RATE, tables=None, inputs=None, **called):
        """Write it as an FMU, with other tables, inputs, name or title where they are given."""
        led, inputs = self.tables | (tables or {}), self.inputs if inputs is None else inputs
        options = {"kind": kind, "name": self.name, "title": self.title, "tables": led, "inputs": inputs} | called
        return write_fmu(self.library, self.values, path, t_end=t_end, rate=rate, **options)


def steer(name):
    """Load a scene with its constant loads as inputs."""
    scene, inputs = steer_loads(load_scene(str(name)))
    model = build_model(scene)
    return Steered(scene.name, build(obtain(model)), model.values(), dict(model.tables), inputs, scene.title)
