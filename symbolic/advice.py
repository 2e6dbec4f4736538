"""What is odd about a scene but no defect: effects that it calls for and that cannot act in it."""

from collections.abc import Iterator

from .build import build_model
from .model import Model
from .schema import Scene
from .validate import meshes

NEEDS = {
    "mesh_friction": ("pitch-point", "mesh_friction", "no mesh has a friction table; give one its coefficient"),
    "bearing_friction": ("on", "pin_friction", "no pin has friction or friction_damping; give one"),
    "gravity": ("on", "gravity", "no member can move sideways"),
}


def warnings(scene: Scene, model: Model | None = None) -> list[str]:
    """Return one line for every effect that is on and leaves no trace in the model."""
    return list(_idle_effects(scene, model or build_model(scene)))


def _idle_effects(scene: Scene, model: Model) -> Iterator[str]:
    """List the effects that are on without an element of theirs."""
    groups = {instance.group for instance in model.instances}
    for effect, (value, group, reason) in NEEDS.items():
        if scene.effects[effect] == value and group not in groups:
            yield f"effects.{effect} = {value!r} cannot act: {reason}"
    gaps = [mesh.backlash for stage in scene.stages.values() for _, mesh, *_ in meshes(stage)]
    if scene.effects["contact"] == "backlash" and not all(gap > 0 for gap in gaps):
        yield "effects.contact = 'backlash': a mesh has no gap, so both its flanks wedge when centres approach"
    misplaced = any(getattr(stage, "position_errors", []) for stage in scene.stages.values())
    if scene.effects["planet_position_error"] == "on" and not misplaced:
        yield "effects.planet_position_error = 'on' cannot act: no stage has position_errors; give one"
    if scene.effects["mesh_stiffness"] == "two-level" and groups & {"mesh"} and not model.levels:
        yield "effects.mesh_stiffness = 'two-level' cannot act: no mesh has a double_factor; give one, or choose mean"
