"""Meshes of a model: law, stiffness, errors, damper, contact, friction, phase."""

from collections.abc import Iterable, Mapping
from math import cos, pi, sin, sqrt

from ltcgear.generated.contract import BACK, COUNT, DAMPER, GEOMETRY, HOMOTOPY, POSITIVE, PULL, VARYING, Clock

from ..elements.key import ElementKey, Option
from ..gears import gear_geometry
from ..gears.train_members import members
from ..mechanics.model import PHASE, TURN, Body, Level, Phase
from ..schema.scene_schema import Eccentricity, Planetary
from .draft import Draft, MeshPlace
from .mesh_errors import bind_error, pin_turn
from .mesh_losses import add_friction
from .reduced_inertia import reduced, swinging
from .stiffness import bind_stiffness


def add_mesh(draft: Draft, at: MeshPlace) -> None:
    """Add one mesh: its law, stiffness, errors, damper, friction and phase; equal meshes share their numbers."""
    name, effects = at.name, draft.scene.effects
    geometry = gear_geometry.mesh_geometry(at.stage, *at.wheels, at.sigma)
    force = draft.statics[name]
    sign = {"auto": -1.0 if force < 0 else 1.0, "printed": 1.0, "opposite": -1.0}[at.mesh.flank]
    at.sense = -1 if _relative(draft, at) * (draft.rigid.speed or 1.0) < 0 else 1
    at.backwards = sign * at.sense < 0
    bind = {
        "r_1": draft.number(f"{name}.base_radius_1", geometry.r1, "m", GEOMETRY, POSITIVE),
        "r_2": draft.number(f"{name}.base_radius_2", geometry.r2, "m", GEOMETRY, POSITIVE),
        "s": draft.number(f"{name}.flank", sign, "", COUNT),
    }
    bodies = _teeth(draft, at)
    at.in_plane = effects["lateral"] == "on" or bodies != at.members
    law = effects["mesh_law"] if at.in_plane else "torsional"
    if at.in_plane:
        bind |= _in_plane(draft, at, geometry, law)
    elif isinstance(at.stage, Planetary):
        law, bodies = "orbiting", (*bodies, f"{name.split('.')[0]}.carrier")
    mean = bind_stiffness(draft, at, bind)
    error = bind_error(draft, at, bind)
    if draft.on("mesh_damping"):
        _mesh_damping(draft, at, geometry, mean, bind)
    kind = "external" if at.sigma > 0 else "internal"
    options = {"switched": "level" in bind, "damped": "c" in bind, "error": error, "followed": "k_d" in bind}
    _contact(draft, at, bodies, {"kind": kind, "law": law, **options}, bind)
    if at.mesh.friction is not None and effects["mesh_friction"] != "off":
        # Friction needs the place of the contact, even where nothing moves sideways.
        add_friction(
            draft,
            at,
            bodies=_teeth(draft, at),
            law=effects["mesh_law"],
            place=_in_plane(draft, at, geometry, effects["mesh_law"]),
        )
    if at.wheels[0].teeth is not None:
        _phase(draft, at)


def _relative(draft: Draft, at: MeshPlace) -> float:
    """Return the speed of gear 1 relative to the line of centres, over the reference speed."""
    stage = at.name.split(".")[0]
    return draft.rigid.ratios[at.members[0]] - draft.rigid.ratios.get(f"{stage}.carrier", 0.0)


def _in_plane(draft: Draft, at: MeshPlace, geometry: gear_geometry.MeshGeometry, law: str) -> dict[str, str]:
    """Bind the line of centres and the reference of deflections."""
    bind = {
        "e_x": draft.number(f"{at.label}.e_x", cos(at.direction), "", GEOMETRY),
        "e_y": draft.number(f"{at.label}.e_y", sin(at.direction), "", GEOMETRY),
        "Delta_gamma_0": TURN,
    }
    if law == "involute":
        bind["inv_0"] = draft.number(f"{at.name}.inv_alpha_0", gear_geometry.involute(geometry.alpha), "rad", GEOMETRY)
    else:
        bind["d_0"] = draft.number(f"{at.name}.center_distance", geometry.distance, "m", GEOMETRY)
    return bind


def _teeth(draft: Draft, at: MeshPlace) -> tuple[str, ...]:
    """Return the bodies that carry the teeth: the gears, or the tooth centres of eccentric ones."""
    return tuple(
        member if item is None or not draft.on("eccentricity") else _eccentric(draft, member, item)
        for member, item in zip(at.members, _eccentricities(at), strict=True)
    )


def _eccentricities(at: MeshPlace) -> list[Eccentricity | None]:
    """Return the eccentricities of a mesh's gears."""
    found: list[Eccentricity | None] = [gear.eccentricity for gear in at.wheels]
    if isinstance(at.stage, Planetary):
        number = int(at.label.rsplit(".", 1)[1])
        found[1] = next((item for item in at.stage.eccentricities if item.planet == number), None)
    return found


def _eccentric(draft: Draft, member: str, item: Eccentricity) -> str:
    """Add the centre of an eccentric gear's teeth, once for all its meshes."""
    name = f"{member}.teeth"
    if name not in {body.name for body in draft.bodies}:
        gear = next(body for body in draft.bodies if body.name == member)
        place = (
            draft.number(f"{name}.x_0", item.radius * cos(item.angle), "m", GEOMETRY),
            draft.number(f"{name}.y_0", item.radius * sin(item.angle), "m", GEOMETRY),
        )
        leader = gear.leader or gear.name
        kin = gear.ratio.removesuffix(".speed_ratio") if gear.ratio else member
        draft.turn(kin, gear.ratio, draft.frames[gear.frame])
        draft.bodies.append(
            Body(name, (), "point", None, None, gear.ratio, place, gear.frame, leader, gear.name)
        )  # fmt: skip
    return name


def _contact(
    draft: Draft, at: MeshPlace, bodies: tuple[str, ...], options: Mapping[str, Option], bind: dict[str, str]
) -> None:
    """Add a mesh: bilateral, on one flank, or on both flanks with a gap at the unloaded one."""
    contact = draft.scene.effects["contact"]
    if contact == "bilateral":
        draft.place(at.label, ElementKey.of("mesh", contact="bilateral", **options), bodies, at.name, **bind)
        return
    pull = draft.number(PULL, 0.0, "", HOMOTOPY)
    hold = draft.hold(at.label, "N")
    element = ElementKey.of("mesh", contact="one-flank", **options)
    draft.place(at.label, element, bodies, at.name, pull=pull, hold=hold, **bind)
    if contact == "backlash":
        back = {
            "s": draft.number(f"{at.name}.other_flank", -draft.parameters[f"{at.name}.flank"].value, "", COUNT),
            "gap": draft.number(f"{at.name}.backlash", gear_geometry.backlash(at.stage, at.mesh, *at.wheels), "m"),
            "hold": draft.hold(at.label + BACK, "N"),
        }
        draft.place(at.label + BACK, ElementKey.of("mesh", contact="gap", **options), bodies, at.name, **bind | back)


def _mesh_damping(
    draft: Draft, at: MeshPlace, geometry: gear_geometry.MeshGeometry, mean: float, bind: dict[str, str]
) -> None:
    """Bind the mesh damper: Rayleigh's, given, or 2 zeta sqrt(k m) on the equivalent mass 1/(r1^2/I1 + r2^2/I2)."""
    factors = draft.rayleigh
    value = at.mesh.damping if factors is None else factors.stiffness * mean
    if value is None and at.mesh.damping_ratio is not None:
        everyone = members(draft.scene)
        kin = [body if body in everyone else body.rsplit(".", 1)[0] for body in at.members]
        one, two = (swinging(draft, key) for key in kin)
        mass = reduced(one / geometry.r1**2, two / geometry.r2**2)
        value = 2 * at.mesh.damping_ratio * sqrt(mean * mass)
    if value:
        bind["c"] = draft.number(f"{at.name}.damping", value, "N*s/m", bounds=DAMPER)


def _phase(draft: Draft, at: MeshPlace) -> None:
    """Register the mesh phase: teeth of gear 1 that have passed the line of centres in the rigid motion (eqs 10-11).

    It increases in the initial direction of rotation, so that every mesh begins with the single contact of eq 9,
    shifted by its planet's position; ``teeth_1`` is negative if gear 1 turns clockwise.
    """
    relative = _relative(draft, at)
    teeth = at.sense * (at.wheels[0].teeth or 0)
    per_turn = draft.number(f"{at.name}.teeth_1", teeth, "", COUNT)
    start = draft.number(f"{at.label}.phase", at.mesh.phase - teeth * at.ahead / (2 * pi), "", GEOMETRY)
    rolled = start
    turn = None if at.in_plane else pin_turn(draft, at)
    if turn is not None:
        # A mesh that knows angles only does not see where its pin stands.
        before = at.mesh.phase - teeth * (at.ahead + turn) / (2 * pi)
        rolled = draft.number(f"{at.label}.rolled_phase", before, "", GEOMETRY)
    runs = draft.rigid.mode != "rest" and relative != 0.0
    if runs:
        _clocks(draft, at, per_turn, dict.fromkeys((start, rolled)))
    followed = any(profile.mesh == at.label for profile in draft.profiles)
    if followed:
        draft.number(VARYING, 1.0, "", HOMOTOPY)
    followed |= any(i.name.removesuffix(BACK) == at.label and PHASE in i.bind.values() for i in draft.instances)
    rate = None
    if runs and (at.switched or followed):
        rate = draft.number(f"{at.name}.cycles", teeth * relative / (2 * pi), "1/rad", COUNT)
    if at.switched:
        draft.levels.append(Level(at.label, rate, start, f"{at.name}.single_share"))
    draft.phases.append(Phase(at.label, per_turn, at.members[0], rate, start, rolled, followed))


def _clocks(draft: Draft, at: MeshPlace, teeth: str, starts: Iterable[str]) -> None:
    """Register the clocks of a mesh: the period of a pitch, and that of a gear with single-tooth errors."""
    gear = next(body for body in draft.bodies if body.name == at.members[0])
    frame = draft.frames[gear.frame]
    single = (profile for profile in draft.profiles if (profile.mesh, profile.kind) == (at.label, "tooth"))
    periods = tuple(dict.fromkeys(profile.numbers[2] for profile in single))
    draft.clocks += [Clock(start, teeth, gear.ratio or "", frame or "", periods, at.label) for start in starts]
