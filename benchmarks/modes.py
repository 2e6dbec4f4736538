"""Modes of a long train, and what they take: writes the tables of docs/modes.md."""

from ltcgear.symbolic.builder import SceneBuilder
from ltcgear.symbolic.schema import Scene

from .growth.scenes import stage_keys


def long_train(stages: int, planets: int) -> Scene:
    """Put planetary stages in a row, of which every other one is turned round, so that no shaft turns fast.

    Parameters
    ----------
    stages
        How many; each has a sun, a carrier and its planets, and a ring that is fixed.
    planets
        Planets of each stage.
    """
    scene = SceneBuilder(f"{stages} stages of {planets} planets", mesh_stiffness="mean")
    for k in range(1, stages + 1):
        scene.planetary(f"stage{k}", **stage_keys(planets))
    for k in range(1, stages):
        end = "sun" if k % 2 else "carrier"
        ends = f"stage{k}.{end}", f"stage{k + 1}.{end}"
        scene.coupling(f"shaft{k}", *ends, stiffness="1e7 N*m/rad", damping_ratio=0.02)
    last = "sun" if stages % 2 else "carrier"
    scene.load("drive", "stage1.carrier", speed="2 rpm").load("brake", f"stage{stages}.{last}", torque="-5 N*m")
    return scene.build()
