"""Bodies with what is rigidly joined to them: inertia, static moment, centre of mass."""

from ltcgear.generated.contract import GEOMETRY

from ..gears.train_members import inertia_of, members
from ..mechanics.model import Body
from ..schema.scene_schema import Member, Planetary, Rotor
from .draft import Draft
from .rigid import seated


def joined_inertia(draft: Draft, name: str, member: Member | Rotor) -> float:
    """Return the inertia [kg m^2] of all that turns with a leader: shafts' members, planets on their carriers."""
    if name.endswith(".planet"):
        return inertia_of(member)[1]
    everyone = members(draft.scene)
    group = [name, *(other for other, leader in draft.leaders.items() if leader == name)]
    return sum(inertia_of(everyone[other])[1] + seated(draft.scene, other)[1] for other in group)


def is_unbalanced(draft: Draft, name: str) -> bool:
    """Tell whether planets sit unevenly on a member."""
    stage = draft.scene.stages.get(name.split(".")[0])
    if not seated(draft.scene, name)[0] or not isinstance(stage, Planetary):
        return False
    misplaced = draft.on("planet_position_error") and bool(stage.position_errors)
    return stage.planets == 1 or stage.planet_angles is not None or misplaced


def static_moment(draft: Draft, name: str) -> tuple[str, str] | None:
    """Note mass times offset of what sits unevenly on a carrier."""
    if not is_unbalanced(draft, name):
        return None
    _, _, x, y = seated(draft.scene, name)
    return draft.number(f"{name}.static_moment_x", x, "kg*m", GEOMETRY), draft.number(
        f"{name}.static_moment_y", y, "kg*m", GEOMETRY
    )


def mass_centre(draft: Draft, body: Body, mass: float) -> Body:
    """Return the point of a body at which its weight acts: itself, or a point of its own where it is unbalanced."""
    if not is_unbalanced(draft, body.name):
        return body
    place = tuple(
        draft.number(f"{body.name}.mass_centre.{axis}_0", moment / mass, "m", GEOMETRY)
        for axis, moment in zip("xy", seated(draft.scene, body.name)[2:], strict=True)
    )
    return Body(
        f"{body.name}.mass_centre", (), "point", None, None, body.ratio, (place[0], place[1]), body.frame,
        body.leader or body.name, body.name,
    )  # fmt: skip
