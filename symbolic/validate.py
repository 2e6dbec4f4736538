"""What the schema cannot see: names that refer to nothing, gears that cannot mesh, motion that is open."""

from collections.abc import Iterator
from difflib import get_close_matches

from . import gears, train
from .schema import Gear, Mesh, Pair, Planetary, Scene, Stage


def validate(scene: Scene) -> list[str]:
    """Return every defect of a scene that is well-formed, each as key, reason and cure."""
    faults = [*_references(scene), *(f for name, stage in scene.stages.items() for f in _stage(name, stage))]
    if not scene.stages and not scene.rotors:
        faults.append("stages: the scene has no member; add a stage or a rotor")
    return faults or train.motion(scene)[1]


def _references(scene: Scene) -> Iterator[str]:
    """Check the names in loads and couplings."""
    everyone = train.members(scene)
    known = [name for name in everyone if not name.endswith(".planet")]
    used = [(f"loads.{key}.member", load.member) for key, load in scene.loads.items()]
    used += [(f"couplings.{key}.between", name) for key, item in scene.couplings.items() for name in item.between]
    for key, name in used:
        if name not in known:
            near = get_close_matches(name, known, 1)
            cure = f'did you mean "{near[0]}"?' if near else f"members: {', '.join(known)}"
            yield f"{key}: there is no member {name!r}; {cure}"
    for key, load in scene.loads.items():
        if load.member in known and train.is_fixed(everyone[load.member]):
            yield f'loads.{key}: {load.member} has support = "fixed" and cannot be driven; free it or drop the load'
    for key, item in scene.couplings.items():
        if item.between[0] == item.between[1]:
            yield f"couplings.{key}.between: both ends are {item.between[0]!r}"
    held = [load.member for load in scene.loads.values() if load.speed is not None]
    for name in sorted({name for name in held if held.count(name) > 1}):
        yield f"loads: the speed of {name} is given twice"


def _stage(name: str, stage: Planetary | Pair) -> Iterator[str]:
    """Check one stage: tooth system, centre distance, meshes, assembly."""
    key = f"stages.{name}"
    parts = ("ring", "sun", "planet") if isinstance(stage, Planetary) else ("input", "output")
    missing = list(_tooth_system(key, stage, {part: getattr(stage, part) for part in parts}))
    yield from missing
    if missing:
        return
    for mesh_name, mesh, one, two, sigma in meshes(stage):
        yield from _mesh(f"{key}.{mesh_name}", stage, mesh, one, two, sigma)
    if isinstance(stage, Planetary):
        yield from _planetary(key, stage)


def meshes(stage: Planetary | Pair) -> list[tuple[str, Mesh, Gear, Gear, int]]:
    """Return the meshes of a stage: name, mesh, gear 1, gear 2, sign of the pair."""
    if isinstance(stage, Pair):
        return [("mesh", stage.mesh, stage.input, stage.output, 1)]
    return [
        ("sun_planet", stage.sun_planet, stage.sun, stage.planet, 1),
        ("ring_planet", stage.ring_planet, stage.ring, stage.planet, -1),
    ]


def _tooth_system(key: str, stage: Stage, wheels: dict[str, Gear]) -> Iterator[str]:
    """Check that radii and centre distance can be computed."""
    if stage.pressure_angle is not None and not 0.0 < stage.pressure_angle < 0.8:
        yield f"{key}.pressure_angle: must lie between 0 and 45 deg"
    if not -0.8 < stage.helix_angle < 0.8:
        yield f"{key}.helix_angle: must lie between -45 and 45 deg"
    toothed = stage.module is not None and stage.pressure_angle is not None
    for part, gear in wheels.items():
        if gear.base_radius is None and (gear.teeth is None or not toothed):
            yield f"{key}.{part}: give teeth (with the stage's module and pressure_angle) or base_radius"
    if stage.center_distance is None and not (toothed and all(g.teeth for g in wheels.values())):
        yield f"{key}.center_distance: is missing; it follows from teeth only with module and pressure_angle"


def _mesh(key: str, stage: Planetary | Pair, mesh: Mesh, one: Gear, two: Gear, sigma: int) -> Iterator[str]:
    """Check one mesh: base circles, reference gear, contact ratio."""
    base = gears.base_radius(stage, one) + sigma * gears.base_radius(stage, two)
    distance = gears.stage_distance(stage)
    if not 0 < base < distance:
        kind = "sum" if sigma > 0 else "difference"
        yield (
            f"{key}: the base circles' {kind} {base * 1e3:.3f} mm must lie between 0 and the centre distance "
            f"{distance * 1e3:.3f} mm; check teeth, module and center_distance"
        )
        return
    allowed = {
        "sun_planet": ("sun", "planet"),
        "ring_planet": ("ring", "planet"),
        "mesh": ("input", "output"),
    }
    choices = allowed[key.rsplit(".", 1)[-1]]
    if mesh.reference is not None and mesh.reference not in choices:
        yield f"{key}.reference: must be one of {', '.join(choices)}"
    if mesh.double_factor is None:
        return
    if one.teeth is None or two.teeth is None:
        yield f"{key}.double_factor: switching needs the teeth of both gears"
    elif mesh.contact_ratio is None:
        if stage.module is None or stage.pressure_angle is None:
            yield f"{key}.contact_ratio: is missing; without module and pressure_angle it cannot be computed"
            return
        ratio = gears.contact_ratio(stage, one, two, sigma, distance)
        if not 1 < ratio < 2:
            yield (
                f"{key}.contact_ratio: full-depth teeth would have {ratio:.3f}, outside 1 to 2; "
                "give contact_ratio, or drop double_factor"
            )


def _planetary(key: str, stage: Planetary) -> Iterator[str]:
    """Check that sun, planets and ring go together."""
    sun, planet, ring = stage.sun, stage.planet, stage.ring
    if stage.carrier.support == "floating" and stage.sun.support == "floating" and stage.ring.support == "floating":
        yield f"{key}: sun, ring and carrier all float, so nothing holds the stage; give one of them a bearing"
    if sun.teeth is None or planet.teeth is None or ring.teeth is None:
        return
    if stage.planet_angles is None and (sun.teeth + ring.teeth) % stage.planets:
        yield (
            f"{key}.planets: {stage.planets} equally spaced planets cannot be assembled, since "
            f"({sun.teeth} + {ring.teeth}) / {stage.planets} is not whole; give planet_angles"
        )
    if stage.center_distance is None:
        inner = gears.standard_centre_distance(stage, sun, planet, 1)
        outer = gears.standard_centre_distance(stage, ring, planet, -1)
        if abs(inner - outer) > 1e-6 * inner:
            yield (
                f"{key}.center_distance: teeth and profile shifts give {inner * 1e3:.3f} mm for sun-planet but "
                f"{outer * 1e3:.3f} mm for ring-planet; choose profile shifts that agree, or give center_distance"
            )
