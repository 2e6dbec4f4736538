"""Steered loads: constant loads become loads over time, which another program sets at run time."""

from ..schema.scene_schema import Scene
from ..schema.series import Pairs


def steer_loads(scene: Scene) -> tuple[Scene, tuple[str, ...]]:
    """Replace constant loads by constant tables over time.

    A speed is replaced only if it is the one that drives the train: others have a fixed ratio to it.

    Parameters
    ----------
    scene
        A validated scene.

    Returns
    -------
    tuple
        The scene with its loads over time, and the names of the tables that replace numbers.
    """
    held = [name for name, load in scene.loads.items() if load.holds and (load.speed_over_time or load.speed)]
    loads, tables = dict(scene.loads), []
    for name, load in scene.loads.items():
        if load.torque is not None:
            loads[name] = load.model_copy(update={"torque": None, "torque_over_time": _constant(load.torque)})
            tables.append(f"loads.{name}.torque_over_time")
        elif load.speed and held == [name]:
            loads[name] = load.model_copy(update={"speed": None, "speed_over_time": _constant(load.speed)})
            tables.append(f"loads.{name}.speed_over_time")
    return scene.model_copy(update={"loads": loads}), tuple(tables)


def _constant(value: float) -> Pairs:
    """Return a table of one value."""
    return ((0.0, value), (1.0, value))
