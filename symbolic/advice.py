"""What is odd about a scene but no defect: effects that it calls for and that cannot act in it."""

from collections.abc import Iterator

from . import gears
from .build import build_model
from .effects import EFFECTS
from .model import Model
from .schema import Scene
from .validate import meshes
from .variants import same_model, with_value


def warnings(scene: Scene, model: Model | None = None) -> list[str]:
    """Return one line for every effect that is on and leaves no trace in the model."""
    return [*_idle_effects(scene, model or build_model(scene)), *_wedged(scene)]


def _idle_effects(scene: Scene, model: Model) -> Iterator[str]:
    """List the effects whose model is the same when they are left out."""
    for effect in EFFECTS:
        value = scene.effects[effect.name]
        if value not in effect.needs:
            continue
        others = [other for other in dict.fromkeys((effect.without, effect.default)) if other != value]
        if any(same_model(build_model(with_value(scene, effect.name, other)), model) for other in others):
            yield f"effects.{effect.name} = {value!r} cannot act: it needs {effect.needs[value]}"


def _wedged(scene: Scene) -> Iterator[str]:
    """Warn of backlash without a gap."""
    gaps = [
        gears.backlash(stage, mesh, *pair) for stage in scene.stages.values() for _, mesh, *pair, _ in meshes(stage)
    ]
    if scene.effects["contact"] == "backlash" and not all(gap > 0 for gap in gaps):
        yield "effects.contact = 'backlash': a mesh has no gap, so both its flanks wedge when centres approach"
