"""Modes of a scene, also of the scene that a result holds."""

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from ltcgear.generated.errors import LtcgearError

if TYPE_CHECKING:
    from ltcgear.symbolic.mechanics.model import Model

    from ..linear.modes import Mode
    from ..linear.system import Linear
    from ..model.library import Library
    from ..results.result import Result
    from ..view.report.page import Background

MANY = 150
"""Freedoms above which only the lowest `FEW` modes are found unless all are asked for."""
FEW = 40


def linearise_model(library: "Library", model: "Model", turn: float | None = None) -> "Linear":
    """Find the equilibrium of a model and linearise it there."""
    from ..linear.system import linearise
    from ..model.equilibrium import find_equilibrium
    from ..model.operating_point import OperatingPoint

    p = library.parameters(model.values())
    return linearise(OperatingPoint(library, p, find_equilibrium(library, p, tables=model.tables)), turn)


def choose_count(linear: "Linear") -> int | None:
    """Return how many modes are found of a system; None for all."""
    return FEW if len(linear.positions) > MANY else None


@dataclass(frozen=True)
class Restored:
    """What the scene that a result holds tells: sources of numbers, linear system and modes, or why there are none."""

    sources: dict[str, str] = field(default_factory=dict)
    linear: "Linear | None" = None
    modes: "tuple[Mode, ...]" = ()
    why: str = ""


def restore_modes(scene_json: str, wanted: bool = True) -> Restored:
    """Find the modes of the scene that a result holds, as ``ltcgear modes`` does; what cannot be had is left out."""
    from ltcgear.symbolic.assembly import build_model
    from ltcgear.symbolic.emit.pipeline import obtain
    from ltcgear.symbolic.scene.load import restore_scene

    from ..linear.modes import find_modes
    from ..linear.naming import describe_modes
    from ..model.building import build

    if not scene_json:
        return Restored(why="the file holds no scene")
    try:
        scene = restore_scene(scene_json)
    except LtcgearError as error:
        return Restored(why=f"the scene in the file is not understood ({error})")
    sources = dict(scene.sources)
    if not wanted:
        return Restored(sources, why="left out by --no-modes")
    try:
        model = build_model(scene)
        linear = linearise_model(build(obtain(model)), model)
        return Restored(sources, linear, tuple(describe_modes(linear, find_modes(linear, choose_count(linear)))))
    except LtcgearError as error:
        return Restored(sources, why=str(error))


def find_background(result: "Result", modes: bool) -> "Background":
    """Return sources and modes of the scene that a result holds; what cannot be had is left out, with the reason."""
    from ..view.report.page import Background

    found = restore_modes(str(result.dataset.attrs.get("scene_json", "")), modes)
    return Background(found.sources, found.linear, found.modes, found.why + ".")
