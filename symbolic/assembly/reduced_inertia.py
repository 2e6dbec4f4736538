"""Reduced inertia of members that swing against each other, to which damping ratios refer."""

from ..gears.train_members import inertia_of, members
from .draft import Draft
from .rigid import turning_of


def reduced(one: float, two: float) -> float:
    """Return the reduced inertia of two that swing against each other; 0 stands for a held one."""
    parts = [1 / value for value in (one, two) if value > 0]
    return 1 / sum(parts) if parts else 0.0


def swinging(draft: Draft, name: str) -> float:
    """Return a member's own inertia, 0 where its motion, or that of the member it is joined to, is held."""
    everyone = members(draft.scene)
    leader = draft.leaders.get(name, name)
    held = turning_of(draft.scene, draft.rigid, leader, everyone[leader]) in ("held", "driven")
    return 0.0 if held else inertia_of(everyone[name])[1]
