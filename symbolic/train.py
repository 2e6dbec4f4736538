"""Rigid-body motion and statics of a train: speed ratios, mesh loads, loaded flanks.

Both are linear systems over the members that turn; planets of a stage move alike here.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from . import gears
from .schema import Member, Pair, Planetary, Rotor, Scene

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Motion:
    """The rigid motion: which load sets the reference speed, and every member's speed over it.

    ``mode`` is ``rest``, ``speed`` (the reference is held) or ``torque`` (it is a member's own motion).
    """

    mode: str
    member: str
    speed: float
    ratios: dict[str, float]


def members(scene: Scene) -> dict[str, Member | Rotor]:
    """Return every member by dotted name; a stage's planets appear once, as ``stage.planet``."""
    found: dict[str, Member | Rotor] = dict(scene.rotors)
    for name, stage in scene.stages.items():
        parts = ("ring", "sun", "carrier", "planet") if isinstance(stage, Planetary) else ("input", "output")
        found |= {f"{name}.{part}": getattr(stage, part) for part in parts}
    return found


def is_fixed(member: Member | Rotor) -> bool:
    """Tell whether a member is clamped."""
    return isinstance(member, Member) and member.support == "fixed"


def inertia_of(member: Member | Rotor) -> tuple[float, float]:
    """Return mass [kg] and inertia [kg m^2]: given, or of the disc (m = rho pi (R^2 - r^2) w)."""
    if member.disc is None:
        return getattr(member, "mass", None) or 0.0, member.inertia or 0.0
    outer, inner = member.disc.outer_diameter / 2, member.disc.inner_diameter / 2
    mass = member.disc.density * np.pi * (outer**2 - inner**2) * member.disc.width
    return float(mass), float(mass * (outer**2 + inner**2) / 2)


def planet_angles(stage: Planetary) -> list[float]:
    """Return where the planets stand [rad]: given, or equally spaced."""
    return stage.planet_angles or [2 * np.pi * i / stage.planets for i in range(stage.planets)]


def _wheel(stage: Planetary | Pair, part: str) -> float:
    """Return what stands for a gear in a speed ratio: teeth where they set all radii, else base radius."""
    names = ("ring", "sun", "planet") if isinstance(stage, Planetary) else ("input", "output")
    if all(getattr(stage, name).teeth is not None and getattr(stage, name).base_radius is None for name in names):
        return float(getattr(stage, part).teeth)
    return gears.base_radius(stage, getattr(stage, part))


def _rolling_rows(scene: Scene, column: dict[str, int]) -> list[tuple[str, Vector]]:
    """Return the rows of rolling without slip and of shafts that turn together (eqs 2 and 18)."""
    rows: list[tuple[str, Vector]] = []

    def add(label: str, **terms: float) -> None:
        row = np.zeros(len(column))
        for key, value in terms.items():
            row[column[key]] += value
        rows.append((label, row))

    for name, stage in scene.stages.items():
        if isinstance(stage, Planetary):
            sun, planet, ring = (_wheel(stage, part) for part in ("sun", "planet", "ring"))
            place = {part: f"{name}.{part}" for part in ("sun", "planet", "ring", "carrier")}
            add(name, **{place["sun"]: sun, place["planet"]: planet, place["carrier"]: -sun - planet})
            add(name, **{place["ring"]: ring, place["planet"]: -planet, place["carrier"]: planet - ring})
        else:
            add(name, **{f"{name}.input": _wheel(stage, "input"), f"{name}.output": _wheel(stage, "output")})
    for name, coupling in scene.couplings.items():
        add(f"couplings.{name}", **{coupling.between[0]: 1.0, coupling.between[1]: -1.0})
    return rows


def motion(scene: Scene) -> tuple[Motion, list[str]]:
    """Solve the rigid motion; the second value lists what makes it impossible or ambiguous."""
    everyone = members(scene)
    column = {name: i for i, name in enumerate(everyone)}
    held = {load.member: load.speed for load in scene.loads.values() if load.speed is not None}
    begun = {load.member: load.initial_speed for load in scene.loads.values() if load.initial_speed is not None}
    given = begun | held
    if not given:
        return Motion("rest", "", 0.0, dict.fromkeys(everyone, 0.0)), []
    # A member that is braked to zero cannot be the reference of those that turn.
    lead = next((name for name in (*held, *begun) if given[name]), next(iter(held or begun)))
    speed = given[lead]
    rows = [row / np.abs(row).max() for _, row in _rolling_rows(scene, column)]
    right = [0.0] * len(rows)
    still = {name for name, member in everyone.items() if is_fixed(member) or member.torsional_support}
    fixed_speeds = dict.fromkeys(still, 0.0) | {
        name: value / speed if speed else float(name == lead) for name, value in given.items()
    }
    for name, value in fixed_speeds.items():
        row = np.zeros(len(column))
        row[column[name]] = 1.0
        rows.append(row)
        right.append(value)
    matrix, vector = np.array(rows), np.array(right)
    solution, _, rank, _ = np.linalg.lstsq(matrix, vector, rcond=None)
    solution += np.linalg.lstsq(matrix, vector - matrix @ solution, rcond=None)[0]
    solution[np.abs(solution) < 1e-12 * np.abs(solution).max()] = 0.0
    faults = _motion_faults(matrix, vector, solution, int(rank), list(everyone))
    ratios = {name: float(solution[i]) + 0.0 for name, i in column.items()}
    return Motion("speed" if lead in held else "torque", lead, speed, ratios), faults


def _motion_faults(matrix: Vector, vector: Vector, solution: Vector, rank: int, names: list[str]) -> list[str]:
    """Say which speeds contradict each other or stay open."""
    if np.abs(matrix @ solution - vector).max() > 1e-9 * max(1.0, np.abs(solution).max()):
        return ["loads: the speeds contradict the teeth, the fixed members or each other; give fewer speeds"]
    if rank < len(names):
        null = np.linalg.svd(matrix)[2][rank:]
        loose = [name for name, share in zip(names, np.abs(null).max(axis=0), strict=True) if share > 1e-9]
        return [f"loads: the speed of {', '.join(loose)} is open; give a speed or fix a member"]
    return []


def static_forces(scene: Scene, rigid: Motion) -> dict[str, float]:
    """Return the signed normal force [N] per mesh of every stage, lossless, on the printed flank."""
    forces, _ = _statics(scene, rigid)
    return {name: float(forces[i]) for i, name in enumerate(scene.stages)}


def balance_faults(scene: Scene, rigid: Motion) -> list[str]:
    """Say on which members torques are left that no mesh, coupling or held member takes."""
    _, left = _statics(scene, rigid)
    size = max((abs(load.torque or 0.0) for load in scene.loads.values()), default=0.0)
    loose = [name for name, torque in left.items() if abs(torque) > 1e-6 * size]
    if not loose:
        return []
    cure = "give initial_speed to a torque, hold a speed, or fix a member" if rigid.mode == "rest" else "hold a speed"
    return [f"loads: nothing takes the torques that act on {', '.join(loose)}; {cure}"]


def _statics(scene: Scene, rigid: Motion) -> tuple[Vector, dict[str, float]]:
    """Return the unknowns of the static balance, mesh forces [N] first, and the torques [N m] left over.

    Unknowns are the mesh forces, the coupling torques, the reactions of held members and, where
    nothing holds the speed, the acceleration of the reference; they solve in the least-squares sense.
    """
    everyone = members(scene)
    names = [name for name in everyone if not name.endswith(".planet")]
    column = {name: i for i, name in enumerate(names)}
    columns = [_stage_column(name, stage, column) for name, stage in scene.stages.items()]
    for coupling in scene.couplings.values():
        pair = np.zeros(len(names))
        pair[column[coupling.between[0]]], pair[column[coupling.between[1]]] = -1.0, 1.0
        columns.append(pair)
    driven = {load.member for load in scene.loads.values() if load.speed is not None}
    for name in names:
        if is_fixed(everyone[name]) or everyone[name].torsional_support or name in driven:
            columns.append(np.eye(len(names))[column[name]])
    if rigid.mode == "torque":
        columns.append(np.array([-inertia_of(everyone[n])[1] * rigid.ratios[n] for n in names]))
    load = np.zeros(len(names))
    for item in scene.loads.values():
        load[column[item.member]] += item.torque or 0.0
    if not columns:
        return np.zeros(0), dict(zip(names, load.tolist(), strict=True))
    matrix = np.array(columns).T
    forces = np.linalg.lstsq(matrix, -load, rcond=None)[0]
    return forces, dict(zip(names, (matrix @ forces + load).tolist(), strict=True))


def _stage_column(name: str, stage: Planetary | Pair, column: dict[str, int]) -> Vector:
    """Return the torques on all members by one newton in each mesh of a stage, on the printed flank."""
    torques = np.zeros(len(column))
    if isinstance(stage, Planetary):
        sun, ring = gears.base_radius(stage, stage.sun), gears.base_radius(stage, stage.ring)
        torques[column[f"{name}.sun"]] = -stage.planets * sun
        torques[column[f"{name}.ring"]] = -stage.planets * ring
        torques[column[f"{name}.carrier"]] = stage.planets * (sun + ring)
    else:
        torques[column[f"{name}.input"]] = -gears.base_radius(stage, stage.input)
        torques[column[f"{name}.output"]] = -gears.base_radius(stage, stage.output)
    return torques


def loose_sideways(stage: Planetary | Pair) -> list[str]:
    """Return the floating members that the meshes and pins of a stage leave free to move sideways.

    One row a spring (mesh or pin), one column a freedom: floating members and planets in the plane, and
    the turning that the meshes tie (two central members held: a stage has two freedoms to turn).
    """
    floating = [part for part in _central(stage) if getattr(stage, part).support == "floating"]
    rows = _springs(stage)
    columns = [(part, axis) for part in floating for axis in "xy"]
    columns += sorted({key for row in rows for key in row if key[0].isdigit() or key == _turning_part(stage)})
    matrix = np.array([[row.get(key, 0.0) for key in columns] for row in rows])
    _, sizes, modes = np.linalg.svd(matrix)
    free = modes[int((sizes > 1e-6).sum()) :]
    share = np.abs(free).max(axis=0, initial=0.0)
    return [part for part in floating if any(share[columns.index((part, axis))] > 1e-6 for axis in "xy")]


def _central(stage: Planetary | Pair) -> tuple[str, ...]:
    """Return the members of a stage that are not planets."""
    return ("ring", "sun", "carrier") if isinstance(stage, Planetary) else ("input", "output")


def _turning_part(stage: Planetary | Pair) -> tuple[str, str]:
    """Return the one turning of a central member that stays when the others are held."""
    return ("sun", "turn") if isinstance(stage, Planetary) else ("output", "turn")


def _springs(stage: Planetary | Pair) -> list[dict[tuple[str, str], float]]:
    """Return for each spring its stretch by unit motions; turning is counted at the base circle."""
    if isinstance(stage, Pair):
        alpha = gears.mesh_geometry(stage, stage.input, stage.output, 1).alpha
        x, y = np.cos(stage.line_of_centres + np.pi / 2 - alpha), np.sin(stage.line_of_centres + np.pi / 2 - alpha)
        return [
            {("input", "x"): -x, ("input", "y"): -y, ("output", "x"): x, ("output", "y"): y, ("output", "turn"): 1.0}
        ]
    rows: list[dict[tuple[str, str], float]] = []
    meshes = (("sun", stage.sun, 1), ("ring", stage.ring, -1))
    for i, angle in enumerate(planet_angles(stage), start=1):
        rows += [{(f"{i}", axis): 1.0, ("carrier", axis): -1.0} for axis in "xy"]
        for part, gear, sigma in meshes:
            alpha = gears.mesh_geometry(stage, gear, stage.planet, sigma).alpha
            line = stage.line_of_centres + angle + np.pi / 2 - sigma * alpha
            x, y = float(np.cos(line)), float(np.sin(line))
            row = {(f"{i}", "x"): x, (f"{i}", "y"): y, (part, "x"): -x, (part, "y"): -y}
            rows.append(row | {(f"{i}", "turn"): -float(sigma), (part, "turn"): -1.0})
    return rows
