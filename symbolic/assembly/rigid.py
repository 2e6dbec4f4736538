"""Rigid joints of the model: members of rigid shafts, planets on rigid pins."""

from math import cos, sin

from ..gears import gear_geometry
from ..gears.train_members import RigidMotion, inertia_of, is_fixed, members, planet_angles
from ..schema.scene_schema import Member, Planetary, PositionError, Rotor, Scene


def turning_of(scene: Scene, rigid: RigidMotion, name: str, member: Member | Rotor) -> str:
    """Return the description of the angle of a member without a leader."""
    if is_fixed(member):
        return "held"
    if any(load.member == name and load.holds for load in scene.loads.values()):
        return "driven"
    return "reference" if rigid.mode == "torque" and rigid.member == name else "free"


def find_leaders(scene: Scene, rigid: RigidMotion) -> dict[str, str]:
    """Return member -> its leader, whose angle it shares, for all members joined by rigid shafts."""
    if scene.effects["torsional_shafts"] == "flexible":
        return {}
    everyone = members(scene)
    rank = {"held": 0, "driven": 1, "reference": 2, "free": 3}
    group = {name: {name} for name in everyone}
    for coupling in scene.couplings.values():
        joined = group[coupling.between[0]] | group[coupling.between[1]]
        group |= dict.fromkeys(joined, joined)
    order = {name: (rank[turning_of(scene, rigid, name, m)], i) for i, (name, m) in enumerate(everyone.items())}
    found = {name: min(names, key=order.__getitem__) for name, names in group.items()}
    return {name: leader for name, leader in found.items() if leader != name}


def rigid_pins(scene: Scene) -> bool:
    """Tell whether planets sit rigidly on their carriers; without lateral motion they always do."""
    return scene.effects["pins"] == "rigid" or scene.effects["lateral"] == "off"


def in_plane(scene: Scene) -> bool:
    """Tell whether positions of gears matter; without lateral motion meshes need angles only."""
    effects = scene.effects
    return effects["lateral"] == "on" or effects["mesh_friction"] != "off" or effects["eccentricity"] == "on"


def pin_offset(scene: Scene, stage: Planetary, number: int) -> tuple[float, float]:
    """Return the position error of a pin [m], outwards and along the pin circle."""
    if scene.effects["planet_position_error"] == "off":
        return 0.0, 0.0
    error = next((e for e in stage.position_errors if e.planet == number), PositionError(planet=number))
    return error.radial, error.tangential


def pin_places(scene: Scene, stage: Planetary) -> list[tuple[float, float]]:
    """Return the positions of the pins [m], at angle zero of the carrier."""
    distance, places = gear_geometry.stage_distance(stage), []
    for number, angle in enumerate(planet_angles(stage), start=1):
        radial, tangential = pin_offset(scene, stage, number)
        cosine, sine = cos(stage.line_of_centres + angle), sin(stage.line_of_centres + angle)
        radius = distance + radial
        places.append((radius * cosine - tangential * sine, radius * sine + tangential * cosine))
    return places


def seated(scene: Scene, name: str) -> tuple[float, float, float, float]:
    """Return the contribution of planets on a carrier's rigid pins: mass, inertia, and mass times offset [kg m]."""
    stage = scene.stages.get(name.split(".")[0])
    if not (isinstance(stage, Planetary) and name.endswith(".carrier") and rigid_pins(scene)):
        return 0.0, 0.0, 0.0, 0.0
    mass = inertia_of(stage.planet)[0]
    places = pin_places(scene, stage)
    inertia = mass * sum(x * x + y * y for x, y in places)
    return len(places) * mass, inertia, mass * sum(x for x, _ in places), mass * sum(y for _, y in places)
