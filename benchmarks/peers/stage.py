"""The stage that multibody tools are compared on: the low-speed stage of the rig, four planets, mean stiffness.

It starts at its equilibrium and is struck by a step of its torque.
"""

from .rig import Rig, open_rig

SCENE, PLANETS = "lsp", 4
SETTINGS = {"effects.mesh_stiffness": "mean"}
TORSION = SETTINGS | {"effects.lateral": "off"}
STEP = 1.2
"""By how much the torque rises at the start."""


def open_stage(torsional: bool = False) -> Rig:
    """Build the stage."""
    return open_rig(SCENE, TORSION if torsional else SETTINGS)
