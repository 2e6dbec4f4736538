"""Second stage: Scene -> Model, only with the elements that the scene's effects call for."""

from dataclasses import dataclass, field
from math import cos, pi, sin, sqrt

from . import gears, mesh_stiffness, train
from .model import BACK, BASIS, LEVEL, TURN, Body, Instance, Level, Model, Parameter, Rolling
from .schema import (
    Bearing,
    Coupling,
    Gear,
    Member,
    Mesh,
    Pair,
    Planetary,
    PositionError,
    Rotor,
    Scene,
    TorsionalSupport,
)
from .validate import meshes


@dataclass
class Draft:
    """The model while it is being put together (the only mutable value of the pipeline)."""

    scene: Scene
    rigid: train.Motion
    statics: dict[str, float]
    bodies: list[Body] = field(default_factory=list)
    instances: list[Instance] = field(default_factory=list)
    levels: list[Level] = field(default_factory=list)
    rollings: list[Rolling] = field(default_factory=list)
    parameters: dict[str, Parameter] = field(default_factory=dict)
    frames: dict[str, str | None] = field(default_factory=lambda: {"": None})

    def number(self, name: str, value: float, unit: str) -> str:
        """Note a parameter and return its name."""
        self.parameters[name] = Parameter(name, float(value), unit)
        return name

    def place(self, name: str, element: tuple[str | bool, ...], bodies: tuple[str, ...], **bind: str) -> None:
        """Note an element instance."""
        group = str(element[0])
        self.instances.append(Instance(name, group, element, bodies, bind))

    def on(self, effect: str) -> bool:
        """Tell whether an on/off effect is on."""
        return self.scene.effects[effect] == "on"


def build_model(scene: Scene) -> Model:
    """Put the model of a scene together.

    Parameters
    ----------
    scene
        A validated scene.

    Returns
    -------
    Model
        Bodies, element instances and parameters in a fixed order.
    """
    rigid, _ = train.motion(scene)
    draft = Draft(scene, rigid, train.static_forces(scene, rigid))
    if rigid.mode != "rest":
        draft.number("reference.speed", rigid.speed, "rad/s")
    for name, rotor in scene.rotors.items():
        _member(draft, name, rotor, "")
    for name, stage in scene.stages.items():
        if isinstance(stage, Planetary):
            _planetary(draft, name, stage)
        else:
            _pair(draft, name, stage)
    for name, coupling in scene.couplings.items():
        _coupling(draft, name, coupling)
    for name, load in scene.loads.items():
        if load.torque is not None:
            torque = draft.number(f"loads.{name}.torque", load.torque, "N*m")
            draft.place(f"loads.{name}", ("external_torque",), (load.member,), T=torque)
    if draft.on("gravity"):
        _gravity(draft)
    return Model(
        scene.title, scene.name, rigid.mode, tuple(draft.bodies), draft.frames, tuple(draft.instances),
        tuple(draft.levels), tuple(draft.rollings), tuple(draft.parameters.values()), dict(scene.effects),
        draft.statics,
    )  # fmt: skip


def _turning(draft: Draft, name: str, member: Member | Rotor) -> str:
    """Say how a body's angle is described."""
    if train.is_fixed(member):
        return "held"
    if any(load.member == name and load.speed is not None for load in draft.scene.loads.values()):
        return "driven"
    return "reference" if draft.rigid.mode == "torque" and draft.rigid.member == name else "free"


def _member(draft: Draft, name: str, member: Member | Rotor, frame: str, place: tuple[str, str] | None = None) -> None:
    """Add a body that is not a planet, with what ties it to the housing."""
    lateral = isinstance(member, Member) and member.support in ("bearing", "floating")
    _body(draft, name, name, member, lateral, frame, place)
    if isinstance(member, Member) and member.bearing is not None:
        _ground_bearing(draft, name, member.bearing, place)
    if member.torsional_support is not None and not train.is_fixed(member):
        _torsional_support(draft, name, member.torsional_support, train.inertia_of(member)[1])
    if member.drag is not None and not train.is_fixed(member):
        draft.place(f"{name}.drag", ("drag",), (name,), c_t=draft.number(f"{name}.drag", member.drag, "N*m*s/rad"))


def _body(
    draft: Draft, name: str, kin: str, member: Member | Rotor, lateral: bool, frame: str,
    place: tuple[str, str] | None,
) -> None:  # fmt: skip
    """Add a body; equal planets share the parameters of ``kin``."""
    mass, inertia = train.inertia_of(member)
    turning = _turning(draft, name, member)
    moves = turning != "held"
    runs = moves and draft.rigid.mode != "rest" and draft.rigid.ratios[kin] != 0.0
    draft.bodies.append(
        Body(
            name, lateral, turning,
            draft.number(f"{kin}.mass", mass, "kg") if lateral else None,
            draft.number(f"{kin}.inertia", inertia, "kg*m^2") if moves else None,
            draft.number(f"{kin}.speed_ratio", draft.rigid.ratios[kin], "") if runs else None,
            place, frame,
        )
    )  # fmt: skip


def _damper(
    draft: Draft, key: str, item: Bearing | TorsionalSupport | Coupling, inertia: float, unit: str
) -> str | None:
    """Note the damper that goes with a spring: given, or 2 zeta sqrt(k m); None where there is none."""
    if not draft.on("damping"):
        return None
    value = item.damping
    if value is None and item.damping_ratio is not None:
        value = 2 * item.damping_ratio * sqrt(item.stiffness * inertia)
    return None if value is None else draft.number(f"{key}.damping", value, unit)


def _origin(draft: Draft, place: tuple[str, str] | None) -> dict[str, str]:
    """Bind x_0, y_0 of a bearing: the body's place, or the shared zero of a centred one."""
    x, y = place or (draft.number("origin", 0.0, "m"),) * 2
    return {"x_0": x, "y_0": y}


def _ground_bearing(draft: Draft, name: str, bearing: Bearing, place: tuple[str, str] | None) -> None:
    """Add the bearing of a member in the housing."""
    mass = draft.parameters[f"{name}.mass"].value
    bind = {"k": draft.number(f"{name}.bearing.stiffness", bearing.stiffness, "N/m")}
    damper = _damper(draft, f"{name}.bearing", bearing, mass, "N*s/m")
    if damper:
        bind["c"] = damper
    draft.place(name, ("ground_bearing", damper is not None), (name,), **bind, **_origin(draft, place))


def _torsional_support(draft: Draft, name: str, support: TorsionalSupport, inertia: float) -> None:
    """Add a torsional spring to the housing."""
    bind = {"k_t": draft.number(f"{name}.torsional_support.stiffness", support.stiffness, "N*m/rad")}
    damper = _damper(draft, f"{name}.torsional_support", support, inertia, "N*m*s/rad")
    if damper:
        bind["c_t"] = damper
    draft.place(name, ("torsional_support", damper is not None), (name,), **bind)


def _reduced(one: float, two: float) -> float:
    """Return the reduced inertia of two that swing against each other; 0 stands for a held one."""
    parts = [1 / value for value in (one, two) if value > 0]
    return 1 / sum(parts) if parts else 0.0


def _swinging(draft: Draft, name: str, member: Member | Rotor) -> float:
    """Return a member's inertia, 0 where its motion is held."""
    held = _turning(draft, name, member) in ("held", "driven")
    return 0.0 if held else train.inertia_of(member)[1]


def _coupling(draft: Draft, name: str, coupling: Coupling) -> None:
    """Add a torsional coupling."""
    everyone = train.members(draft.scene)
    one, two = coupling.between
    inertia = _reduced(_swinging(draft, one, everyone[one]), _swinging(draft, two, everyone[two]))
    bind = {"k_t": draft.number(f"couplings.{name}.stiffness", coupling.stiffness, "N*m/rad")}
    damper = _damper(draft, f"couplings.{name}", coupling, inertia, "N*m*s/rad")
    if damper:
        bind["c_t"] = damper
    draft.place(name, ("coupling", damper is not None), (one, two), **bind)


def _planetary(draft: Draft, name: str, stage: Planetary) -> None:
    """Add a planetary stage in the frame that turns with its carrier."""
    turns = stage.carrier.support != "fixed" and draft.rigid.ratios[f"{name}.carrier"] != 0.0
    for part in ("carrier", "ring", "sun"):
        _member(draft, f"{name}.{part}", getattr(stage, part), name)
    draft.frames[name] = f"{name}.carrier.speed_ratio" if turns else None
    distance = gears.stage_distance(stage)
    angles = stage.planet_angles or [2 * pi * i / stage.planets for i in range(stage.planets)]
    for i, angle in enumerate(angles, start=1):
        planet = f"{name}.planet.{i}"
        direction = stage.line_of_centres + angle
        place = (
            draft.number(f"{planet}.x_0", distance * cos(direction), "m"),
            draft.number(f"{planet}.y_0", distance * sin(direction), "m"),
        )
        _body(draft, planet, f"{name}.planet", stage.planet, True, name, place)
        _pin(draft, name, i, stage, _pin_place(draft, name, i, stage, direction) or place)
        for mesh_name, mesh, one, two, sigma in meshes(stage):
            gear = f"{name}.{mesh_name.split('_')[0]}"
            _mesh(
                draft,
                f"{name}.{mesh_name}",
                f".{i}",
                stage,
                mesh,
                (gear, planet),
                (one, two),
                sigma,
                direction,
            )


def _pin_place(draft: Draft, name: str, number: int, stage: Planetary, direction: float) -> tuple[str, str] | None:
    """Note where a misplaced pin is; None for a pin at its nominal place."""
    if not draft.on("planet_position_error") or not stage.position_errors:
        return None
    error = next((e for e in stage.position_errors if e.planet == number), PositionError(planet=number))
    radius = gears.stage_distance(stage) + error.radial
    x = radius * cos(direction) - error.tangential * sin(direction)
    y = radius * sin(direction) + error.tangential * cos(direction)
    pin = f"{name}.pin.{number}"
    return draft.number(f"{pin}.x_0", x, "m"), draft.number(f"{pin}.y_0", y, "m")


def _pin(draft: Draft, name: str, number: int, stage: Planetary, place: tuple[str, str]) -> None:
    """Add the bearing of one planet on the carrier."""
    bodies = (f"{name}.carrier", f"{name}.planet.{number}")
    bind = {
        "k": draft.number(f"{name}.pin.stiffness", stage.pin.stiffness, "N/m"),
        "x_0": place[0],
        "y_0": place[1],
    }
    mass = draft.parameters[f"{name}.planet.mass"].value
    damper = _damper(draft, f"{name}.pin", stage.pin, mass, "N*s/m")
    label = f"{name}.pin.{number}"
    draft.place(label, ("pin", damper is not None), bodies, **bind, **({"c": damper} if damper else {}))
    if draft.on("bearing_friction") and (stage.pin.friction or stage.pin.friction_damping):
        pin = stage.pin
        draft.place(
            label, ("pin_friction",), bodies, **bind,
            mu=draft.number(f"{name}.pin.friction", pin.friction, ""),
            d_b=draft.number(f"{name}.pin.diameter", pin.diameter or 0.0, "m"),
            c_r=draft.number(f"{name}.pin.friction_damping", pin.friction_damping or 0.0, "N*m*s/rad"),
            omega_0=draft.number(f"{name}.pin.friction_speed", pin.friction_speed, "rad/s"),
            F_0=draft.number(f"{name}.pin.friction_load", pin.friction_load, "N"),
        )  # fmt: skip


def _pair(draft: Draft, name: str, stage: Pair) -> None:
    """Add a parallel pair; the output stands at the centre distance from the input."""
    distance, direction = gears.stage_distance(stage), stage.line_of_centres
    draft.frames[name] = None
    place = (
        draft.number(f"{name}.output.x_0", distance * cos(direction), "m"),
        draft.number(f"{name}.output.y_0", distance * sin(direction), "m"),
    )
    _member(draft, f"{name}.input", stage.input, name)
    _member(draft, f"{name}.output", stage.output, name, place)
    bodies = (f"{name}.input", f"{name}.output")
    _mesh(draft, f"{name}.mesh", "", stage, stage.mesh, bodies, (stage.input, stage.output), 1, direction)


def single_share(stage: Planetary | Pair, mesh: Mesh, one: Gear, two: Gear, sigma: int) -> float:
    """Return the share of a tooth pitch in single contact, 2 - contact ratio (eq 9)."""
    ratio = mesh.contact_ratio or gears.contact_ratio(stage, one, two, sigma, gears.stage_distance(stage))
    return 2.0 - ratio


def _mesh(
    draft: Draft, name: str, number: str, stage: Planetary | Pair, mesh: Mesh, bodies: tuple[str, str],
    wheels: tuple[Gear, Gear], sigma: int, direction: float,
) -> None:  # fmt: skip
    """Add one mesh: its law, level, damper and friction; equal meshes share their numbers."""
    label = name + number
    law = draft.scene.effects["mesh_law"]
    geometry = gears.mesh_geometry(stage, *wheels, sigma)
    single, double = mesh_stiffness.levels(stage, mesh, *wheels, sigma)
    switched = double is not None and draft.scene.effects["mesh_stiffness"] == "two-level"
    force = draft.statics[name]
    sign = {"auto": -1.0 if force < 0 else 1.0, "printed": 1.0, "opposite": -1.0}[mesh.flank]
    bind = {
        "r_1": draft.number(f"{name}.base_radius_1", geometry.r1, "m"),
        "r_2": draft.number(f"{name}.base_radius_2", geometry.r2, "m"),
        "e_x": draft.number(f"{label}.e_x", cos(direction), ""),
        "e_y": draft.number(f"{label}.e_y", sin(direction), ""),
        "s": draft.number(f"{name}.flank", sign, ""),
        "Delta_gamma_0": TURN,
    }
    if law == "involute":
        bind["inv_0"] = draft.number(f"{name}.inv_alpha_0", gears.involute(geometry.alpha), "rad")
    else:
        bind["d_0"] = draft.number(f"{name}.center_distance", geometry.distance, "m")
    share = 1.0 if double is None else single_share(stage, mesh, *wheels, sigma)
    mean = _stiffness(draft, name, single, double, share, switched, bind)
    if draft.on("mesh_damping"):
        _mesh_damping(draft, name, mesh, bodies, geometry, mean, bind)
    kind = "external" if sigma > 0 else "internal"
    _contact(draft, name, label, mesh, bodies, (kind, law, switched, "c" in bind), bind)
    if draft.scene.effects["mesh_friction"] == "pitch-point" and mesh.friction is not None:
        bind.pop("c", None)
        bind |= {
            "mu": draft.number(f"{name}.friction.coefficient", mesh.friction.coefficient, ""),
            "v_0": draft.number(f"{name}.friction.speed", mesh.friction.speed, "m/s"),
            "c_t": draft.number(f"{name}.friction.damping", mesh.friction.damping or 0.0, "N*s/m"),
        }
        draft.place(label, ("mesh_friction", kind, law, switched), bodies, **bind)
    if wheels[0].teeth is not None:
        _phase(draft, name, label, mesh, bodies[0], wheels[0].teeth, direction, switched)


def _contact(
    draft: Draft, name: str, label: str, mesh: Mesh, bodies: tuple[str, str], form: tuple[str | bool, ...],
    bind: dict[str, str],
) -> None:  # fmt: skip
    """Place a mesh: bilateral, on one flank, or on both flanks with a gap before the one not loaded."""
    contact = draft.scene.effects["contact"]
    if contact == "bilateral":
        draft.place(label, ("mesh", *form), bodies, **bind)
        return
    draft.place(label, ("mesh", *form, "one-flank"), bodies, pull=draft.number("contact.pull", 0.0, ""), **bind)
    if contact == "backlash":
        back = {
            "s": draft.number(f"{name}.other_flank", -draft.parameters[f"{name}.flank"].value, ""),
            "gap": draft.number(f"{name}.backlash", mesh.backlash, "m"),
        }
        draft.place(label + BACK, ("mesh", *form, "gap"), bodies, **bind | back)


def _stiffness(
    draft: Draft, name: str, single: float, double: float | None, share: float, switched: bool, bind: dict[str, str]
) -> float:
    """Bind the stiffness (one value, or two and a level) and return its mean over a pitch [N/m]."""
    mean = single if double is None else single * share + double * (1 - share)
    if not switched:
        bind["k"] = draft.number(f"{name}.stiffness", mean, "N/m")
        return mean
    bind["k_1"] = draft.number(f"{name}.stiffness_single", single, "N/m")
    bind["k_2"] = draft.number(f"{name}.stiffness_double", double or single, "N/m")
    bind["level"] = LEVEL
    draft.number(f"{name}.single_share", share, "")
    return mean


def _mesh_damping(
    draft: Draft, name: str, mesh: Mesh, bodies: tuple[str, str], geometry: gears.MeshGeometry, mean: float,
    bind: dict[str, str],
) -> None:  # fmt: skip
    """Bind the mesh damper: given, or 2 zeta sqrt(k m) on the gears' equivalent mass 1/(r1^2/I1 + r2^2/I2)."""
    value = mesh.damping
    if value is None and mesh.damping_ratio is not None:
        everyone = train.members(draft.scene)
        kin = [body if body in everyone else body.rsplit(".", 1)[0] for body in bodies]
        one, two = (_swinging(draft, key, everyone[key]) for key in kin)
        mass = _reduced(one / geometry.r1**2, two / geometry.r2**2)
        value = 2 * mesh.damping_ratio * sqrt(mean * mass)
    if value:
        bind["c"] = draft.number(f"{name}.damping", value, "N*s/m")


def _phase(
    draft: Draft, name: str, label: str, mesh: Mesh, gear: str, teeth: int, direction: float, switched: bool
) -> None:
    """Note the mesh phase: teeth of gear 1 that have passed the line of centres (eqs 10-11).

    It counts up in the sense in which the gears turn at the start, so that every mesh begins with the
    single contact of eq 9, shifted by its planet's place; ``teeth_1`` is negative where that is clockwise.
    """
    stage = name.split(".")[0]
    relative = draft.rigid.ratios[gear] - draft.rigid.ratios.get(f"{stage}.carrier", 0.0)
    sense = -teeth if relative * (draft.rigid.speed or 1.0) < 0 else teeth
    per_turn = draft.number(f"{name}.teeth_1", sense, "")
    start = draft.number(f"{label}.phase", mesh.phase - sense * direction / (2 * pi), "")
    draft.rollings.append(Rolling(label, per_turn, gear, start))
    if not switched:
        return
    runs = draft.rigid.mode != "rest" and relative != 0.0
    rate = draft.number(f"{name}.cycles", sense * relative / (2 * pi), "1/rad") if runs else None
    draft.levels.append(Level(label, rate, start, f"{name}.single_share"))


def _gravity(draft: Draft) -> None:
    """Add the weight of every body that can move sideways."""
    x, y = draft.scene.gravity
    bind = {"g_x": draft.number("gravity.x", x, "m/s^2"), "g_y": draft.number("gravity.y", y, "m/s^2")}
    for body in draft.bodies:
        if body.lateral and body.mass is not None:
            draft.place(body.name, ("gravity",), (body.name,), m=body.mass, beta=BASIS, **bind)
