"""Variants of a scene without one effect, and the contribution of each effect."""

from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace

from ltcgear.generated.errors import LtcgearError

from ..assembly import build_model
from ..mechanics.model import Instance, Model
from ..schema.effects import BY_NAME, EFFECTS, contradictions
from ..schema.scene_schema import Scene


@dataclass(frozen=True)
class Change:
    """One effect of a scene at another value."""

    effect: str
    value: str
    without: str


def with_value(scene: Scene, effect: str, value: str) -> Scene:
    """Return the scene with another value of one effect."""
    return scene.model_copy(update={"effects": scene.effects | {effect: value}})


def list_changes(scene: Scene, model: Model) -> list[Change]:
    """List the simplifications of a scene, one effect at a time.

    Parameters
    ----------
    scene, model
        A scene and its model.

    Returns
    -------
    list of Change
        Every active effect at the value without it, and every other value of an effect that removes degrees of freedom.
        Changes that contradict another effect are included, idle effects are not.
    """
    return [change for effect in EFFECTS for change in _changes_of(scene, model, effect.name)]


def _changes_of(scene: Scene, model: Model, effect: str) -> Iterator[Change]:
    """Yield the changes of one effect that simplify the scene."""
    value, plain = scene.effects[effect], BY_NAME[effect].without
    for other in BY_NAME[effect].values:
        if other == value:
            continue
        change = Change(effect, value, other)
        try:
            made = build_model(with_value(scene, effect, other))
        except LtcgearError:
            made = None
        if made is None or any(contradictions(scene.effects | {effect: other})):
            if other == plain:
                yield change
        elif not same_model(made, model) and (other == plain or made.freedoms < model.freedoms):
            yield change


def same_model(one: Model, two: Model) -> bool:
    """Tell whether two models have the same C and the same numbers."""
    return (one.structure(), one.values()) == (two.structure(), two.values())


def acting_effects(scene: Scene, model: Model) -> list[dict[str, str]]:
    """Describe the contribution of every active effect.

    Returns
    -------
    list of dict
        ``effect``, ``value``, ``help`` of the table, and ``here``: what it adds to the model.
    """
    listed = []
    for effect in EFFECTS:
        value = scene.effects[effect.name]
        if value == effect.without:
            continue
        here = _difference(build_model(with_value(scene, effect.name, effect.without)), model)
        if not here:
            continue
        listed.append({"effect": effect.name, "value": value, "help": effect.help, "here": here})
    return listed


def _difference(plain: Model, model: Model) -> str:
    """Say what a model has in addition to a simpler one."""
    before, now = _written(plain), _written(model)
    changed = [now[key] for key in now if key in before and now[key] != before[key]]
    old, new = plain.values(), model.values()
    parts = [
        *_counted([now[key] for key in now if key not in before], "more"),
        *_counted([before[key] for key in before if key not in now], "less"),
        *_counted(changed, "with other terms"),
        _number(len(model.levels) - len(plain.levels), "stiffness that switches", "stiffnesses that switch"),
        _number(model.freedoms - plain.freedoms, "freedom more", "freedoms more"),
        _number(plain.freedoms - model.freedoms, "freedom less", "freedoms less"),
        _number(len(set(new) - set(old)), "number more", "numbers more"),
        _number(sum(new[key] != old[key] for key in set(new) & set(old)), "other value", "other values"),
    ]
    return ", ".join(part for part in parts if part)


def _written(model: Model) -> dict[str, Instance]:
    """Return the element instances by name and law; which axes are live is a matter of the model, not of theirs."""
    return {i.name + i.group: replace(i, element=replace(i.element, live=())) for i in model.instances}


def _counted(instances: list[Instance], words: str) -> list[str]:
    """Count elements by kind."""
    found = Counter(instance.group.replace("_", " ") for instance in instances)
    return [f"{name}: {count} {words}" for name, count in found.items()]


def _number(count: int, one: str, several: str) -> str:
    """Write a count of something; empty for zero."""
    return "" if count <= 0 else f"{count} {one if count == 1 else several}"
