"""Mass-proportional part of Rayleigh damping; the other part is in the dampers beside the springs."""

from ..elements.key import ElementKey
from .draft import Draft


def add_rayleigh(draft: Draft) -> None:
    """Add the mass-proportional part to every body with its own degrees of freedom."""
    factors = draft.rayleigh
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
