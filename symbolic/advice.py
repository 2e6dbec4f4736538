"""What is odd about a scene but no defect: effects that it calls for and that cannot act in it."""

from collections.abc import Iterator

from .build import build_model
from .model import Model
from .schema import Scene

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
    if scene.effects["mesh_stiffness"] == "two-level" and groups & {"mesh"} and not model.levels:
        yield "effects.mesh_stiffness = 'two-level' cannot act: no mesh has a double_factor; give one, or choose mean"
