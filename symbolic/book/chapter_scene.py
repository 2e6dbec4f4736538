"""Chapters on the scene: description, active effects, motion, and numbers with their sources."""

from collections.abc import Iterable, Iterator, Mapping
from typing import Any

from ..describe.freedoms import explain_freedoms
from ..describe.geometry_report import describe
from ..mechanics.model import Model
from ..schema.scene_schema import Scene
from .chapter_laws import write_unit
from .content import Chapter, Part


def write_scene(chapter: Chapter, scene: Scene, model: Model, effects: Iterable[Mapping[str, str]]) -> None:
    """Write the chapter on the scene, with the effects that act in it."""
    shown = describe(scene)
    chapter.say(
        f"{scene.title}. Members: {len(model.bodies)}; elements between them and to the housing: "
        f"{len(model.instances)}; numbers: {len(model.parameters)}. What is not listed here leaves no symbol, no "
        "state and no operation in the C."
    )
    chapter.head("Effects that act", "effects")
    rows = [(row["effect"], row["value"], row["help"], row["here"]) for row in effects]
    chapter.tabulate(("effect", "value", "what it does", "what it adds here"), rows)
    if not rows:
        chapter.say("No effect beyond the simplest model acts.")
    chapter.head("Members", "members")
    members = [
        (name, str(entry["count"]), *(_plain(entry[key]) for key in ("speed_rpm", "mass_kg", "inertia_kg_m2")))
        for name, entry in shown["members"].items()
    ]
    chapter.tabulate(("member", "count", "speed [r/min]", "mass [kg]", "inertia [kg m²]"), members)
    chapter.head("Freedoms", "freedoms")
    moving = [(str(r["body"]), ", ".join(r["axes"]), str(r["reason"])) for r in explain_freedoms(scene, model)]
    chapter.tabulate(("body", "moves in", "because"), moving)
    chapter.head("Loads", "loads")
    loads = [
        (name, entry["member"], _plain(entry["torque_n_m"]), _plain(entry["power_kw"]), entry["action"], entry["law"])
        for name, entry in shown["loads"].items()
    ]
    chapter.tabulate(("load", "member", "torque [N m]", "power [kW]", "action", "over time"), loads)
    chapter.head("Numbers and their sources", "numbers")
    chapter.say(
        "Values are in SI units, as the C has them. "
        "A source says whether a number is printed, derived, assumed or fitted."
    )
    chapter.tabulate(("key", "value", "source"), list(_numbers(scene)))


def _plain(value: float | None) -> str:
    """Write a number; empty if unknown."""
    return "" if value is None else f"{value + 0.0:.6g}"


def _numbers(scene: Scene) -> Iterator[tuple[Part, Part, Part]]:
    """List what the scene's file gives."""
    plain = scene.model_dump(mode="json", exclude_none=True, exclude_defaults=True)
    for key in ("title", "name", "sources", "effects"):
        plain.pop(key, None)
    for key, value in _flat(plain, ""):
        yield key, _shortened(value), _source(scene.sources, key)


def _flat(node: Any, path: str) -> Iterator[tuple[str, str]]:  # noqa: ANN401
    """Yield dotted keys and values of nested tables; lists of numbers stay whole."""
    if isinstance(node, dict):
        for key, value in node.items():
            yield from _flat(value, f"{path}.{key}" if path else str(key))
    elif isinstance(node, list) and node and isinstance(node[0], dict):
        for i, value in enumerate(node):
            yield from _flat(value, f"{path}.{i}")
    else:
        yield path, ", ".join(_written(item) for item in node) if isinstance(node, list) else _written(node)


def _written(value: Any) -> str:  # noqa: ANN401
    """Write one value, a quantity with six digits."""
    if isinstance(value, list):
        return "(" + ", ".join(_written(item) for item in value) + ")"
    number, _, unit = str(value).partition(" ")
    try:
        return str(value) if isinstance(value, int) else f"{float(number):.6g} {write_unit(unit) * bool(unit)}".strip()
    except ValueError:
        return str(value)


def _shortened(text: str) -> str:
    """Shorten long tables."""
    return text if len(text) <= 200 else f"{text[:160]} ... {text[-30:]}"


def _source(sources: dict[str, str], key: str) -> str:
    """Return the source of a number: its own, or that of its table."""
    parts = key.split(".")
    return next((s for i in range(len(parts), 0, -1) if (s := sources.get(".".join(parts[:i])))), "given by the scene")
