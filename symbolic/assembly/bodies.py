"""Bodies of the model, their bearings, pins and couplings."""

from math import sqrt

from ltcgear.generated.contract import CLOSING, CONSTANT, COUNT, DAMPER, HOMOTOPY, POSITIVE

from ..elements.key import ElementKey
from ..gears.train_members import inertia_of, is_fixed
from ..mechanics.model import BASIS, Body
from ..schema.scene_schema import Bearing, Coupling, Member, Planetary, Rotor, TorsionalSupport
from .draft import Draft
from .joined_bodies import is_unbalanced, joined_inertia, mass_centre, static_moment
from .reduced_inertia import reduced, swinging
from .rigid import seated, turning_of


def add_member(
    draft: Draft, name: str, member: Member | Rotor, frame: str, place: tuple[str, str] | None = None
) -> None:
    """Add a body that is not a planet, with its connections to the housing."""
    sideways = draft.on("lateral") and isinstance(member, Member) and member.support in ("bearing", "floating")
    add_body(draft, name, name, member, sideways, frame, place)
    if sideways and isinstance(member, Member) and member.bearing is not None:
        _ground_bearing(draft, name, member.bearing, inertia_of(member)[0], place)
    if member.torsional_support is not None and not is_fixed(member):
        _torsional_support(draft, name, member.torsional_support, inertia_of(member)[1])
    if member.drag is not None and not is_fixed(member):
        bind = {"c_t": draft.number(f"{name}.drag", member.drag, "N*m*s/rad")}
        draft.place(f"{name}.drag", ElementKey("drag"), (name,), **bind)


def add_body(
    draft: Draft, name: str, kin: str, member: Member | Rotor, lateral: bool, frame: str,
    place: tuple[str, str] | None, seat: str | None = None,
) -> None:  # fmt: skip
    """Add a body; equal planets share the parameters of ``kin``."""
    leader = draft.leaders.get(name)
    turning = "led" if leader else turning_of(draft.scene, draft.rigid, name, member)
    own = turning not in ("held", "led")  # inertia of its own
    runs = turning != "held" and draft.rigid.mode != "rest" and draft.rigid.ratios[kin] != 0.0
    if lateral:
        draft.turn(f"{frame}.frame", draft.frames[frame])
    mass = inertia_of(member)[0] + seated(draft.scene, name)[0]
    inertia = joined_inertia(draft, kin, member)
    draft.bodies.append(
        Body(
            name, ("x", "y") * lateral + ("u",) * (turning == "free"), turning,
            draft.number(f"{kin}.mass", mass, "kg", bounds=POSITIVE) if lateral else None,
            draft.number(f"{kin}.inertia", inertia, "kg*m^2", bounds=POSITIVE) if own else None,
            draft.number(f"{kin}.speed_ratio", draft.rigid.ratios[kin], "", COUNT) if runs else None,
            place, frame, leader, seat, static_moment(draft, name) if lateral else None,
            kin.removeprefix(f"{frame}.") if frame else "rotor",
        )
    )  # fmt: skip


def _damper(
    draft: Draft, key: str, item: Bearing | TorsionalSupport | Coupling, inertia: float, unit: str
) -> str | None:
    """Register the damper of a spring: given, 2 zeta sqrt(k m), or Rayleigh's; None if there is none."""
    factors = draft.rayleigh
    if factors is not None and factors.stiffness:
        return draft.number(f"{key}.damping", factors.stiffness * item.stiffness, unit, bounds=DAMPER)
    if not draft.on("damping"):
        return None
    value = item.damping
    if value is None and item.damping_ratio is not None:
        value = 2 * item.damping_ratio * sqrt(item.stiffness * inertia)
    return None if value is None else draft.number(f"{key}.damping", value, unit, bounds=DAMPER)


def _origin(draft: Draft, place: tuple[str, str] | None) -> dict[str, str]:
    """Bind x_0, y_0 of a bearing: the body's position, or the shared zero of a centred one."""
    x, y = place or (draft.number("origin", 0.0, "m", CONSTANT),) * 2
    return {"x_0": x, "y_0": y}


def _ground_bearing(draft: Draft, name: str, bearing: Bearing, mass: float, place: tuple[str, str] | None) -> None:
    """Add the bearing of a member in the housing; a damping ratio refers to the member's own mass."""
    bind = {"k": draft.stiffness(f"{name}.bearing.stiffness", bearing.stiffness)}
    damper = _damper(draft, f"{name}.bearing", bearing, mass, "N*s/m")
    if damper:
        bind["c"] = damper
    race = _clearance(draft, f"{name}.bearing", f"{name}.bearing", bearing)
    group = "ground_clearance" if race else "ground_bearing"
    element = ElementKey.of(group, damped=damper is not None)
    draft.place(name, element, (name,), f"{name}.bearing", **bind, **_origin(draft, place), **race)


def _clearance(draft: Draft, label: str, key: str, bearing: Bearing) -> dict[str, str]:
    """Bind the clearance of a bearing, if it has one."""
    if not draft.on("bearing_clearance") or bearing.clearance is None:
        return {}
    return {
        "clearance": draft.number(f"{key}.clearance", bearing.clearance, "m"),
        "closing": draft.number(CLOSING, 0.0, "", HOMOTOPY),
        "epsilon": draft.number("bearing.rounding", 1e-9, "m", CONSTANT),
        "hold": draft.hold(label, "m"),
    }


def _torsional_support(draft: Draft, name: str, support: TorsionalSupport, inertia: float) -> None:
    """Add a torsional spring to the housing."""
    bind = {"k_t": draft.stiffness(f"{name}.torsional_support.stiffness", support.stiffness, "N*m/rad")}
    damper = _damper(draft, f"{name}.torsional_support", support, inertia, "N*m*s/rad")
    if damper:
        bind["c_t"] = damper
    element = ElementKey.of("torsional_support", damped=damper is not None)
    draft.place(name, element, (name,), f"{name}.torsional_support", **bind)


def add_coupling(draft: Draft, name: str, coupling: Coupling) -> None:
    """Add a torsional coupling; a rigid one has no element, its ends share one angle."""
    one, two = coupling.between
    if draft.scene.effects["torsional_shafts"] == "rigid":
        return
    inertia = reduced(swinging(draft, one), swinging(draft, two))
    bind = {"k_t": draft.stiffness(f"couplings.{name}.stiffness", coupling.stiffness, "N*m/rad")}
    damper = _damper(draft, f"couplings.{name}", coupling, inertia, "N*m*s/rad")
    if damper:
        bind["c_t"] = damper
    draft.place(name, ElementKey.of("coupling", damped=damper is not None), (one, two), f"couplings.{name}", **bind)


def add_pin(draft: Draft, name: str, number: int, stage: Planetary, place: tuple[str, str]) -> None:
    """Add the bearing of one planet on the carrier."""
    bodies = (f"{name}.carrier", f"{name}.planet.{number}")
    bind = {
        "k": draft.stiffness(f"{name}.pin.stiffness", stage.pin.stiffness),
        "x_0": place[0],
        "y_0": place[1],
    }
    mass = draft.parameters[f"{name}.planet.mass"].value
    damper = _damper(draft, f"{name}.pin", stage.pin, mass, "N*s/m")
    label = f"{name}.pin.{number}"
    bind |= _clearance(draft, label, f"{name}.pin", stage.pin)
    group = "pin_clearance" if "clearance" in bind else "pin"
    element = ElementKey.of(group, damped=damper is not None)
    draft.place(label, element, bodies, f"{name}.pin", **bind, **({"c": damper} if damper else {}))
    if draft.on("bearing_friction") and (stage.pin.friction or stage.pin.friction_damping):
        pin = stage.pin
        draft.place(
            label, ElementKey(f"{group}_friction"), bodies, **bind,
            mu=draft.number(f"{name}.pin.friction", pin.friction, ""),
            d_b=draft.number(f"{name}.pin.diameter", pin.diameter or 0.0, "m"),
            c_r=draft.number(f"{name}.pin.friction_damping", pin.friction_damping or 0.0, "N*m*s/rad", bounds=DAMPER),
            omega_0=draft.number(f"{name}.pin.friction_speed", pin.friction_speed, "rad/s", bounds=POSITIVE),
            F_0=draft.number(f"{name}.pin.friction_load", pin.friction_load, "N", bounds=POSITIVE),
        )  # fmt: skip


def add_gravity(draft: Draft) -> None:
    """Add the weight of every body with lateral motion."""
    for body in list(draft.bodies):
        if body.lateral and body.mass is not None:
            _weigh(draft, body, body.mass)
        elif body.turning != "held" and is_unbalanced(draft, body.name):
            # What sits unevenly on a carrier that only turns still turns it by its weight.
            _weigh(
                draft,
                body,
                draft.number(f"{body.name}.seated_mass", seated(draft.scene, body.name)[0], "kg", bounds=POSITIVE),
            )


def _weigh(draft: Draft, body: Body, mass: str) -> None:
    """Add the weight of one body, at its centre of mass."""
    x, y = draft.scene.gravity
    bind = {"g_x": draft.number("gravity.x", x, "m/s^2"), "g_y": draft.number("gravity.y", y, "m/s^2")}
    centre = mass_centre(draft, body, draft.parameters[mass].value)
    if centre is not body:
        draft.bodies.append(centre)
    draft.turn(f"{body.frame}.frame", draft.frames[body.frame])
    draft.place(body.name, ElementKey("gravity"), (centre.name,), m=mass, beta=BASIS, **bind)
