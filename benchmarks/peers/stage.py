"""The stage that multibody tools are compared on: the low-speed stage of the rig, four planets, mean stiffness."""

from .rig import Rig, open_rig

SCENE, PLANETS = "lsp", 4
SETTINGS = {"effects.mesh_stiffness": "mean"}


def open_stage() -> Rig:
    """Build the stage."""
    return open_rig(SCENE, SETTINGS)
