"""Meshes of a model: law, stiffness, damper, friction, phase."""

from math import cos, pi, sin, sqrt

from .. import gears, mesh_stiffness, train
from ..model import BACK, LEVEL, PHASE, TURN, Level, Phase, Rolling
from ..schema import Gear, Mesh, Pair, Planetary
from .bodies import reduced, swinging
from .draft import Draft
from .friction import add_friction
from .rayleigh import rayleigh_of


def add_mesh(
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
    share = 1.0 if double is None else gears.single_share(stage, mesh, *wheels, sigma)
    mean = _stiffness(draft, name, single, double, share, switched, bind)
    if draft.on("mesh_damping"):
        _mesh_damping(draft, name, mesh, bodies, geometry, mean, bind)
    kind = "external" if sigma > 0 else "internal"
    _contact(draft, name, label, mesh, bodies, (kind, law, switched, "c" in bind), bind)
    add_friction(draft, name, label, stage, mesh, wheels, sigma)
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
    """Bind the mesh damper: Rayleigh's, given, or 2 zeta sqrt(k m) on the equivalent mass 1/(r1^2/I1 + r2^2/I2)."""
    factors = rayleigh_of(draft)
    value = mesh.damping if factors is None else factors.stiffness * mean
    if value is None and mesh.damping_ratio is not None:
        everyone = train.members(draft.scene)
        kin = [body if body in everyone else body.rsplit(".", 1)[0] for body in bodies]
        one, two = (swinging(draft, key, everyone[key]) for key in kin)
        mass = reduced(one / geometry.r1**2, two / geometry.r2**2)
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
    followed = any(i.name.removesuffix(BACK) == label and PHASE in i.bind.values() for i in draft.instances)
    if not (switched or followed):
        return
    runs = draft.rigid.mode != "rest" and relative != 0.0
    rate = draft.number(f"{name}.cycles", sense * relative / (2 * pi), "1/rad") if runs else None
    if switched:
        draft.levels.append(Level(label, rate, start, f"{name}.single_share"))
    if followed:
        draft.phases.append(Phase(label, rate, start))
