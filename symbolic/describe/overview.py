"""Overview of a scene and its model in plain numbers, shown by ``ltcgear info``."""

from typing import Any

from ltcgear.generated.contract import Manifest

from ..mechanics.model import Model
from ..schema.scene_schema import Scene
from .freedoms import explain_freedoms
from .geometry_report import describe
from .variants import acting_effects


def survey(scene: Scene, model: Model, manifest: Manifest) -> dict[str, Any]:
    """Return sizes, effects, degrees of freedom, geometry, motion and loads, ready for JSON.

    Parameters
    ----------
    scene, model, manifest
        A scene, its model, and the manifest of its C.
    """
    rigid = [s for s in manifest.states if not s.name.endswith(".rate") and not s.name.startswith("reference.")]
    return {
        "scene": scene.name,
        "title": scene.title,
        "dof": len(rigid) + any(s.name == "reference.speed" for s in manifest.states),
        "states": len(manifest.states),
        "parameters": len(manifest.parameters),
        "effects": model.effects,
        "acting": acting_effects(scene, model),
        "freedoms": explain_freedoms(scene, model),
        "ops": {name: manifest.functions[n].operations for name, n in (("rhs", "rhs"), ("jacobian", "jac_rhs"))},
        "jacobian_nnz": manifest.functions["jac_rhs"].nonzeros,
        "levels": len(manifest.levels),
        "static_mesh_forces_n": {name: abs(force) for name, force in model.statics.items()},
        "speed_ratios": {
            p.name.removesuffix(".speed_ratio"): p.value for p in model.parameters if p.name.endswith(".speed_ratio")
        },
        **describe(scene),
    }
