"""Steered loads: constant loads become loads over time, which another program sets while the C runs."""

from ..schema.scene_schema import Scene
from ..schema.series import Pairs


def steer_loads(scene: Scene) -> tuple[Scene, tuple[str, ...]]:
    """Turn loads that are one number into tables that are constant.

    A speed is turned only if it is the one speed that drives the train: others are in a fixed ratio to it.

    Parameters
    ----------
    scene
        A validated scene.

    Returns
    -------
    tuple
        The scene with its loads over time, and the names of the tables that stand for numbers.
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
