"""Warnings about a scene without defects: effects that cannot act, machines that cannot hold their loads."""

from collections.abc import Iterator
from math import pi

from ..assembly import build_model
from ..gears import gear_geometry, train
from ..mechanics.model import Model
from ..scene.validate import meshes
from ..schema.effects import EFFECTS
from ..schema.scene_schema import Scene
from .variants import same_model, with_value


def warnings(scene: Scene, model: Model | None = None) -> list[str]:
    """Return one line for every effect without influence on the model, and for machines beyond breakdown."""
    return [*_idle_effects(scene, model or build_model(scene)), *_wedged(scene), *_overloaded(scene)]


def _idle_effects(scene: Scene, model: Model) -> Iterator[str]:
    """List the effects that do not change the model."""
    for effect in EFFECTS:
        value = scene.effects[effect.name]
        if value not in effect.needs or (value == effect.default and not scene.stages):
            continue
        others = [other for other in dict.fromkeys((effect.without, effect.default)) if other != value]
        if any(same_model(build_model(with_value(scene, effect.name, other)), model) for other in others):
            yield f"effects.{effect.name} = {value!r} cannot act: it needs {effect.needs[value]}"


def _wedged(scene: Scene) -> Iterator[str]:
    """Warn of backlash without a gap."""
    gaps = [
        gear_geometry.backlash(stage, mesh, *pair)
        for stage in scene.stages.values()
        for _, mesh, *pair, _ in meshes(stage)
    ]
    if scene.effects["contact"] == "backlash" and not all(gap > 0 for gap in gaps):
        yield "effects.contact = 'backlash': a mesh has no gap, so both its flanks wedge when centres approach"


def _overloaded(scene: Scene) -> Iterator[str]:
    """Warn of asynchronous machines loaded above their breakdown torque, or running beyond that point."""
    machines = {name: load for name, load in scene.loads.items() if load.slip is not None}
    rigid = train.motion(scene)[0] if machines else None
    if rigid is None or rigid.mode == "rest":
        return
    asked = sum(rigid.ratios[load.member] * train.final_torque(load) for load in scene.loads.values())
    held = sum(abs(rigid.ratios[load.member]) * load.slip.breakdown_torque for load in machines.values() if load.slip)
    for name, load in machines.items():
        slip, ratio = load.slip, rigid.ratios[load.member]
        if slip is None or not ratio:
            continue
        speed = ratio * rigid.speed
        beyond = (speed - slip.synchronous_speed) / slip.synchronous_speed
        if rigid.mode == "torque" and abs(asked) > held:
            yield (
                f"loads.{name}.slip: the other loads ask {abs(asked / ratio):.6g} N m of it, above its "
                f"breakdown_torque {held / abs(ratio):.6g} N m, so the train runs away or stalls; "
                "give a larger breakdown_torque, or smaller loads"
            )
        elif beyond > slip.breakdown_slip or (speed and rigid.mode == "speed" and -beyond > slip.breakdown_slip):
            yield (
                f"loads.{name}.slip: at {speed * 30 / pi:.6g} r/min its slip is {beyond:.3g}, beyond its "
                f"breakdown_slip {slip.breakdown_slip:g}, where its torque fades; check synchronous_speed and the "
                "speed of the train"
            )
