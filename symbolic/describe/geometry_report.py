"""Geometry, rigid motion and loads of a scene in numbers."""

from collections.abc import Iterator
from itertools import pairwise
from math import degrees, pi, sin, tau
from typing import Any

from ..gears import gear_geometry, train
from ..gears.mesh_stiffness import levels
from ..gears.train_members import RigidMotion, inertia_of, members, planet_angles
from ..scene.validate import meshes
from ..schema.mesh_schema import Mesh
from ..schema.scene_schema import Gear, Load, Pair, Planetary, Scene

UNLOADED = 1e-9  # of the largest torque over the base radius: below, a static force is rounding
RPM = 30 / pi  # [r/min] per [rad/s]

Entry = dict[str, Any]


def describe(scene: Scene) -> dict[str, dict[str, Entry]]:
    """Return a scene's geometry, motion and loads in plain numbers, ready for JSON.

    Parameters
    ----------
    scene
        A validated scene.

    Returns
    -------
    dict
        ``stages``, ``members`` and ``loads``, each by name; units are in the keys, None is unknown.
    """
    rigid, _ = train.motion(scene)
    statics = train.static_forces(scene, rigid)
    speeds = {name: rigid.speed * ratio for name, ratio in rigid.ratios.items()}
    return {
        "stages": {name: _stage(name, stage, speeds, statics) for name, stage in scene.stages.items()},
        "members": _members(scene, speeds),
        "loads": _loads(scene, rigid, speeds),
    }


def load_warnings(scene: Scene) -> list[str]:
    """Return one line for every unloaded mesh in a scene with loads."""
    if not scene.loads:
        return []
    rigid = train.motion(scene)[0]
    statics = train.static_forces(scene, rigid)
    largest = max(abs(torque) for torque in _torques(scene, rigid).values())
    return [
        f"stages.{name}.{key}: no load reaches this mesh, so its teeth are not held together; "
        "check the loads' members and torques, and the couplings"
        for name, stage in scene.stages.items()
        for key, _, one, _, _ in meshes(stage)
        if abs(statics[f"{name}.{key}"]) <= UNLOADED * largest / gear_geometry.base_radius(stage, one)
    ]


def _wheels(stage: Planetary | Pair) -> dict[str, Gear]:
    """Return a stage's gears by part."""
    parts = ("ring", "sun", "planet") if isinstance(stage, Planetary) else ("input", "output")
    return {part: getattr(stage, part) for part in parts}


def _stage(name: str, stage: Planetary | Pair, speeds: dict[str, float], statics: dict[str, float]) -> Entry:
    """Describe one stage."""
    clearance = tip_clearance(stage) if isinstance(stage, Planetary) else None
    return {
        "kind": stage.kind,
        "planets": stage.planets if isinstance(stage, Planetary) else None,
        "center_distance_mm": gear_geometry.stage_distance(stage) * 1e3,
        "base_radii_mm": {part: gear_geometry.base_radius(stage, gear) * 1e3 for part, gear in _wheels(stage).items()},
        "mesh_frequency_hz": _mesh_frequency(name, stage, speeds),
        "planet_tip_clearance_mm": None if clearance is None else clearance * 1e3,
        "meshes": {
            key: _mesh(stage, mesh, one, two, sigma) | {"static_force_n": abs(statics[f"{name}.{key}"])}
            for key, mesh, one, two, sigma in meshes(stage)
        },
    }


def _mesh(stage: Planetary | Pair, mesh: Mesh, one: Gear, two: Gear, sigma: int) -> Entry:
    """Describe one mesh: operating pressure angle, contact ratio, stiffness of single and double contact."""
    single, double = levels(stage, mesh, one, two, sigma)
    return {
        "pressure_angle_deg": degrees(gear_geometry.mesh_geometry(stage, one, two, sigma).alpha),
        "contact_ratio": mesh.contact_ratio or _contact_ratio(stage, one, two, sigma),
        "contact_ratio_given": mesh.contact_ratio is not None,
        "stiffness_single_n_per_m": single,
        "stiffness_double_n_per_m": double,
    }


def _contact_ratio(stage: Planetary | Pair, one: Gear, two: Gear, sigma: int) -> float | None:
    """Return the contact ratio of full-depth teeth; None without teeth, or with tip interference."""
    if stage.module is None or stage.pressure_angle is None or not (one.teeth and two.teeth):
        return None
    distance = gear_geometry.stage_distance(stage)
    if gear_geometry.interference(stage, one, two, sigma, distance):
        return None
    return gear_geometry.contact_ratio(stage, one, two, sigma, distance)


def _mesh_frequency(name: str, stage: Planetary | Pair, speeds: dict[str, float]) -> float | None:
    """Return the mesh frequency [Hz], relative to the carrier; None if no gear has teeth."""
    frame = speeds[f"{name}.carrier"] if isinstance(stage, Planetary) else 0.0
    for part, gear in _wheels(stage).items():
        if gear.teeth:
            return abs(gear.teeth * (speeds[f"{name}.{part}"] - frame)) / tau
    return None


def tip_clearance(stage: Planetary) -> float | None:
    """Return the clearance [m] between full-depth tip circles of neighbouring planets; None if undefined."""
    planet = stage.planet
    if stage.planets < 2 or stage.module is None or stage.pressure_angle is None or planet.teeth is None:
        return None
    around = sorted(angle % tau for angle in planet_angles(stage))
    gap = min(two - one for one, two in pairwise([*around, around[0] + tau]))
    tip = planet.teeth * gear_geometry.transverse(stage)[0] / 2 + stage.module * (1 + planet.profile_shift)
    return 2 * gear_geometry.stage_distance(stage) * sin(gap / 2) - 2 * tip


def _members(scene: Scene, speeds: dict[str, float]) -> dict[str, Entry]:
    """Describe all members; the equal planets of a stage are one entry with their count."""
    listed: dict[str, Entry] = {}
    for name, member in members(scene).items():
        mass, inertia = inertia_of(member)
        stage = scene.stages.get(name.split(".")[0])
        listed[name] = {
            "count": stage.planets if isinstance(stage, Planetary) and name.endswith(".planet") else 1,
            "speed_rpm": speeds[name] * RPM,
            "mass_kg": mass or None,
            "inertia_kg_m2": inertia or None,
        }
    return listed


def _loads(scene: Scene, rigid: RigidMotion, speeds: dict[str, float]) -> dict[str, Entry]:
    """Describe all loads; power is torque times speed, positive into the train.

    Loads over time have their largest torque and ``over_time``.
    """
    return {
        name: {
            "member": scene.loads[name].member,
            "speed_rpm": speeds[scene.loads[name].member] * RPM,
            "torque_n_m": torque,
            "power_kw": None if power is None else power / 1e3,
            "action": "" if not power else "drives" if power > 0 else "brakes",
            "law": _law(scene.loads[name]),
        }
        for name, torque, power in _powers(scene, rigid, speeds)
    }


def _law(load: Load) -> str:
    """Say in words how a load varies; empty if constant."""
    for pairs, factor, unit in ((load.speed_over_time, RPM, "r/min"), (load.torque_over_time, 1.0, "N m")):
        if pairs is not None:
            values = [value * factor for _, value in pairs]
            span = f"from {pairs[0][0]:g} to {pairs[-1][0]:g} s in {len(pairs)} rows"
            return f"{min(values):.6g} to {max(values):.6g} {unit} over time, {span}"
    if load.slip is not None:
        slip = load.slip
        return (
            f"slip law: {slip.synchronous_speed * RPM:.6g} r/min synchronous, "
            f"breakdown {slip.breakdown_torque:.6g} N m at slip {slip.breakdown_slip:g}"
        )
    return ""


def _torques(scene: Scene, rigid: RigidMotion) -> dict[str, float]:
    """Return load -> torque [N m] as in statics."""
    return {
        name: train.load_torque(load, rigid.ratios[load.member] * rigid.speed) for name, load in scene.loads.items()
    }


def _powers(
    scene: Scene, rigid: RigidMotion, speeds: dict[str, float]
) -> Iterator[tuple[str, float | None, float | None]]:
    """Yield load, torque [N m] and power [W]; one prescribed nonzero speed supplies the balance, without losses."""
    held = [name for name, load in scene.loads.items() if load.speed or load.speed_over_time]
    torques = _torques(scene, rigid)
    missing = -sum(torques[name] * speeds[load.member] for name, load in scene.loads.items()) + 0.0
    for name, load in scene.loads.items():
        speed = speeds[load.member]
        if not load.holds:
            yield name, torques[name], torques[name] * speed
        elif speed == 0:
            yield name, None, 0.0
        else:
            yield name, *((missing / speed + 0.0, missing) if held == [name] else (None, None))
