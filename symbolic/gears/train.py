"""Rigid-body motion and statics of a train: speed ratios, mesh loads, loaded flanks.

Both are linear systems over the rotating members; the planets of a stage move equally here.
"""

from collections.abc import Iterator
from itertools import dropwhile, takewhile

import numpy as np
from numpy.typing import NDArray

from ..schema.scene_schema import Load, Member, Pair, Planetary, Rotor, Scene, Slip
from ..schema.series import Pairs
from . import gear_geometry
from .train_members import RigidMotion, inertia_of, is_fixed, members

Vector = NDArray[np.float64]


def _wheel(stage: Planetary | Pair, part: str) -> float:
    """Return the size of a gear in a speed ratio: teeth if they set all radii, else base radius."""
    names = ("ring", "sun", "planet") if isinstance(stage, Planetary) else ("input", "output")
    if all(getattr(stage, name).teeth is not None and getattr(stage, name).base_radius is None for name in names):
        return float(getattr(stage, part).teeth)
    return gear_geometry.base_radius(stage, getattr(stage, part))


def _rolling_rows(scene: Scene, column: dict[str, int]) -> list[tuple[str, Vector]]:
    """Return the rows of rolling without slip and of shafts that rotate together (eqs 2 and 18)."""
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


def motion(scene: Scene) -> tuple[RigidMotion, list[str]]:
    """Solve the rigid motion; the second value lists what makes it impossible or ambiguous."""
    everyone = members(scene)
    column = {name: i for i, name in enumerate(everyone)}
    tables = {load.member: load.speed_over_time for load in scene.loads.values() if load.speed_over_time is not None}
    held = {name: chief_speed(pairs) for name, pairs in tables.items()}
    held |= {load.member: load.speed for load in scene.loads.values() if load.speed is not None}
    begun = {load.member: load.initial_speed for load in scene.loads.values() if load.initial_speed is not None}
    given = begun | held
    if not given:
        return RigidMotion("rest", "", 0.0, dict.fromkeys(everyone, 0.0)), _driven_from_rest(scene, column)
    # A member that is braked to zero cannot be the reference of those that turn.
    lead = next((name for name in (*held, *begun) if given[name]), next(iter(held or begun)))
    lead = next(iter(tables), lead)
    speed = given[lead]
    rows = [row / np.abs(row).max() for _, row in _rolling_rows(scene, column)]
    right = [0.0] * len(rows)
    still = [name for name, member in everyone.items() if is_fixed(member) or member.torsional_support]
    fixed_speeds = dict.fromkeys(still, 0.0) | {
        name: value / speed if speed else float(name == lead) for name, value in given.items()
    }
    if tables and (apart := _apart(scene, tables, lead)):
        return RigidMotion("speed", lead, speed, dict.fromkeys(everyone, 0.0)), apart
    for name, value in fixed_speeds.items():
        row = np.zeros(len(column))
        row[column[name]] = 1.0
        rows.append(row)
        right.append(value)
    matrix, vector = np.array(rows), np.array(right)
    solution, _, rank, _ = np.linalg.lstsq(matrix, vector, rcond=None)
    solution += np.linalg.lstsq(matrix, vector - matrix @ solution, rcond=None)[0]
    solution[np.abs(solution) < 1e-12 * np.abs(solution).max()] = 0.0
    supports = [i for i, name in enumerate(fixed_speeds, len(rows) - len(fixed_speeds)) if name in _sprung(everyone)]
    faults = _blocking(matrix, vector, solution, supports, list(everyone))
    faults = faults or _motion_faults(matrix, vector, solution, int(rank), list(everyone))
    ratios = {name: float(solution[i]) + 0.0 for name, i in column.items()}
    return RigidMotion("speed" if lead in held else "torque", lead, speed, ratios), faults


def _driven_from_rest(scene: Scene, column: dict[str, int]) -> list[str]:
    """Say which loads would move a train without a known speed."""
    rows = [row for _, row in _rolling_rows(scene, column)]
    rows += [np.eye(len(column))[column[n]] for n, m in members(scene).items() if is_fixed(m) or m.torsional_support]
    if rows and np.linalg.matrix_rank(np.array(rows)) == len(column):
        return []
    return [
        f'loads.{name}: drives a train of which no speed is known; give one load an initial_speed ("0 rpm" from rest)'
        for name, load in scene.loads.items()
        if load.torque_over_time is not None or load.slip is not None
    ]


def chief_speed(pairs: Pairs) -> float:
    """Return a table's value at the start; if that is zero, the largest before it reverses; 0 for none."""
    times, values = zip(*pairs, strict=True)
    start = float(np.interp(0.0, times, values))
    ahead = list(dropwhile(lambda value: value == 0, (value for time, value in pairs if time > 0)))
    return start or max(takewhile(lambda value: value * ahead[0] > 0, ahead), key=abs, default=0.0)


def _apart(scene: Scene, tables: dict[str, Pairs], lead: str) -> list[str]:
    """Say which speeds have no fixed ratio to a speed over time."""
    faults = []
    for key, load in scene.loads.items():
        name = load.member
        if load.initial_speed is not None:
            faults.append(f"loads.{key}.initial_speed: the start follows from the speed over time of {lead}; drop it")
        if load.speed:
            faults.append(f"loads.{key}.speed: beside {lead} with its speed over time it must be zero")
        if name in tables and not _proportional(tables[name], tables[lead]):
            faults.append(
                f"loads.{key}.speed_over_time: must be that of {lead} times a constant, in the same rows; "
                "one speed alone may vary"
            )
    return [f"loads: the speed over time of {lead} is zero from the start on; give a speed"] * (
        not chief_speed(tables[lead])
    ) + faults


def _proportional(one: Pairs, two: Pairs) -> bool:
    """Tell whether two tables are proportional."""
    if [time for time, _ in one] != [time for time, _ in two]:
        return False
    a, b = np.array([value for _, value in one]), np.array([value for _, value in two])
    return bool(np.abs(a * (b @ b) - b * (a @ b)).max() <= 1e-9 * np.abs(a).max() * (b @ b))


def breakdown_speed(slip: Slip) -> float:
    """Return the breakdown slip speed [rad/s], from the synchronous speed to that of the largest torque."""
    return slip.breakdown_slip * abs(slip.synchronous_speed)


def slip_torque(slip: Slip, speed: float) -> float:
    """Return the torque [N m] of the slip law (Kloss) at a speed [rad/s]."""
    z = (speed - slip.synchronous_speed) / breakdown_speed(slip)
    return -2 * slip.breakdown_torque * z / (1 + z**2)


def load_torque(load: Load, speed: float) -> float:
    """Return a load's torque [N m] for statics: the largest over time, or that of the slip law at a speed [rad/s]."""
    if load.slip is not None:
        return slip_torque(load.slip, speed)
    if load.torque_over_time is not None:
        return max((torque for _, torque in load.torque_over_time), key=abs)
    return load.torque or 0.0


def final_torque(load: Load) -> float:
    """Return the torque [N m] that a load keeps in the end, without that of a slip law."""
    return load.torque_over_time[-1][1] if load.torque_over_time is not None else load.torque or 0.0


def _sprung(everyone: dict[str, Member | Rotor]) -> list[str]:
    """Return the members with a torsional spring to the housing."""
    return [name for name, member in everyone.items() if member.torsional_support and not is_fixed(member)]


def _blocking(matrix: Vector, vector: Vector, solution: Vector, supports: list[int], names: list[str]) -> list[str]:
    """Say which torsional supports alone, in rows ``supports``, prevent the rotation that the loads prescribe."""
    if not supports or _is_solved(matrix, vector, solution):
        return []
    kept = np.isin(np.arange(len(vector)), supports, invert=True)
    less, right = matrix[kept], vector[kept]
    freed = np.linalg.lstsq(less, right, rcond=None)[0].astype(float)
    if not _is_solved(less, right, freed):
        return []
    turning = [names[int(np.argmax(matrix[i]))] for i in supports if abs(matrix[i] @ freed) > 1e-9]
    return [
        f"{'stages' if '.' in name else 'rotors'}.{name}.torsional_support: holds a member that the loads turn; drop it"
        for name in turning
    ]


def _is_solved(matrix: Vector, vector: Vector, solution: Vector) -> bool:
    """Tell whether speeds satisfy all constraints."""
    return bool(np.abs(matrix @ solution - vector).max() <= 1e-9 * max(1.0, np.abs(solution).max()))


def _motion_faults(matrix: Vector, vector: Vector, solution: Vector, rank: int, names: list[str]) -> list[str]:
    """Say which speeds contradict each other or are undetermined."""
    if not _is_solved(matrix, vector, solution):
        return ["loads: the speeds contradict the teeth, the fixed members or each other; give fewer speeds"]
    if rank < len(names):
        null = np.linalg.svd(matrix)[2][rank:]
        loose = [name for name, share in zip(names, np.abs(null).max(axis=0), strict=True) if share > 1e-9]
        return [f"loads: the speed of {', '.join(loose)} is open; give a speed or fix a member"]
    return []


def static_forces(scene: Scene, rigid: RigidMotion) -> dict[str, float]:
    """Return the signed normal force [N] in one mesh of each kind, on the printed flank, without friction.

    Unknowns are the mesh forces, the coupling torques, the reactions of clamped or driven members and, without a
    prescribed speed, the acceleration of the reference (which the inertias resist); the solution is by least squares.
    The keys are ``stage.mesh``.
    """
    everyone = members(scene)
    names = list(everyone)
    column = {name: i for i, name in enumerate(names)}
    meshes = {key: row for name, stage in scene.stages.items() for key, row in _mesh_torques(name, stage, column)}
    columns = list(meshes.values())
    for coupling in scene.couplings.values():
        pair = np.zeros(len(names))
        pair[column[coupling.between[0]]], pair[column[coupling.between[1]]] = -1.0, 1.0
        columns.append(pair)
    driven = {load.member for load in scene.loads.values() if load.holds}
    for name in names:
        if is_fixed(everyone[name]) or everyone[name].torsional_support or name in driven:
            columns.append(np.eye(len(names))[column[name]])
    if rigid.mode == "torque":
        columns.append(np.array([-_train_inertia(scene, name) * rigid.ratios[name] for name in names]))
    load = np.zeros(len(names))
    for item in scene.loads.values():
        load[column[item.member]] += load_torque(item, rigid.ratios[item.member] * rigid.speed)
    for name, member in everyone.items():
        load[column[name]] -= (member.drag or 0.0) * rigid.ratios[name] * rigid.speed
    forces = np.linalg.lstsq(np.array(columns).T, -load, rcond=None)[0] if columns else np.zeros(0)
    return {key: float(forces[i]) for i, key in enumerate(meshes)}


def _train_inertia(scene: Scene, name: str) -> float:
    """Return a member's effective inertia [kg m^2]: planets together, and their orbital motion on the carrier."""
    stage = scene.stages.get(name.split(".")[0])
    own = inertia_of(members(scene)[name])[1]
    if not isinstance(stage, Planetary):
        return own
    if name.endswith(".planet"):
        return stage.planets * own
    orbit = stage.planets * inertia_of(stage.planet)[0] * gear_geometry.stage_distance(stage) ** 2
    return own + orbit if name.endswith(".carrier") else own


def _mesh_torques(name: str, stage: Planetary | Pair, column: dict[str, int]) -> Iterator[tuple[str, Vector]]:
    """Yield, per mesh, the torques on all members by a unit force [N] in each such mesh, on the printed flank.

    The pins transfer the balancing torque of a mesh to the carrier.
    """

    def torques(**terms: float) -> Vector:
        row = np.zeros(len(column))
        for part, value in terms.items():
            row[column[f"{name}.{part}"]] = value
        return row

    if isinstance(stage, Pair):
        one, two = gear_geometry.base_radius(stage, stage.input), gear_geometry.base_radius(stage, stage.output)
        yield f"{name}.mesh", torques(input=-one, output=-two)
        return
    count = stage.planets
    sun, ring, planet = (gear_geometry.base_radius(stage, gear) for gear in (stage.sun, stage.ring, stage.planet))
    yield f"{name}.sun_planet", torques(sun=-count * sun, planet=-count * planet, carrier=count * (sun + planet))
    yield f"{name}.ring_planet", torques(ring=-count * ring, planet=count * planet, carrier=count * (ring - planet))
