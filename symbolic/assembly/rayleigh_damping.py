"""Rayleigh damping of the model: dampers in proportion to springs, and to masses."""

from ..elements.key import ElementKey
from ..schema.scene_schema import Rayleigh
from .draft import Draft


def rayleigh_of(draft: Draft) -> Rayleigh | None:
    """Return the two factors if the scene has Rayleigh damping."""
    return draft.scene.rayleigh if draft.scene.effects["damping"] == "rayleigh" else None


def add_rayleigh(draft: Draft) -> None:
    """Add the mass-proportional part to every body with its own degrees of freedom."""
    factors = rayleigh_of(draft)
    if factors is None or not factors.mass:
        return
    alpha = draft.number("rayleigh.mass", factors.mass, "1/s")
    for body in draft.bodies:
        bind = {"m": body.mass} if body.lateral and body.mass else {}
        if body.turning == "free" and body.inertia:
            bind["I"] = body.inertia
        motion = " and ".join(word for key, word in (("m", "shifting"), ("I", "turning")) if key in bind)
        if motion:
            draft.place(body.name, ElementKey.of("rayleigh", motion=motion), (body.name,), alpha=alpha, **bind)
