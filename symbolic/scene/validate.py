"""Validation across tables: unknown names, gears that cannot mesh, undetermined motion."""

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from itertools import pairwise
from math import acos, cos, degrees, pi, tan, tau
from typing import Annotated, Any

from pydantic import Field, TypeAdapter, ValidationError

from ..gears import gear_geometry, mesh_stiffness, train
from ..gears.train_members import is_fixed, members, planet_angles
from ..schema.mesh_schema import MOST_HARMONICS, Mesh
from ..schema.scene_schema import (
    MOST_MEMBERS,
    MOST_PLANETS,
    PARTS,
    Gear,
    Member,
    Pair,
    Planetary,
    Rotor,
    Scene,
    Stage,
    suggest,
)
from .tolerances import oversized

RESERVED = ("reference", "origin", "gravity", "loads", "couplings")
ONE_STAGE: TypeAdapter[Planetary | Pair] = TypeAdapter(Annotated[Planetary | Pair, Field(discriminator="kind")])


def validate(scene: Scene) -> list[str]:
    """Return every defect of a well-formed scene, each as key, reason and cure."""
    plain = {
        "loads": {key: {"member": load.member} for key, load in scene.loads.items()},
        "couplings": {key: {"between": item.between} for key, item in scene.couplings.items()},
    }
    faults = [*_names(scene.stages, scene.rotors), *_references(members(scene), plain)]
    for name, stage in scene.stages.items():
        found = list(_stage(name, stage))
        faults += found or _sliding(name, stage, scene.effects["mesh_friction"])
    if not scene.stages and not scene.rotors:
        faults.append("stages: the scene has no member; add a stage or a rotor")
    return faults or [*_loads(scene)] or train.motion(scene)[1]


def validate_parts(plain: Mapping[str, Any], context: Mapping[str, Any]) -> list[str]:
    """Return the detectable defects of a scene with malformed tables.

    ``context`` is pydantic's, with the folder of the scene file.
    """
    faults: list[str] = []
    if not all(isinstance(plain.get(key, {}), dict) for key in ("stages", "rotors")):
        return faults
    everyone: dict[str, Member | Rotor | None] = dict.fromkeys(_table(plain, "rotors"))
    stages = _table(plain, "stages")
    for name, raw in stages.items():
        try:
            stage = ONE_STAGE.validate_python(raw, context=dict(context))
        except ValidationError:
            kind = raw.get("kind") if isinstance(raw, dict) else None
            parts = PARTS.get(kind) if isinstance(kind, str) else None
            everyone |= dict.fromkeys(f"{name}.{part}" for part in parts or sum(PARTS.values(), ()))
        else:
            everyone |= {f"{name}.{part}": getattr(stage, part) for part in PARTS[stage.kind]}
            faults += _stage(name, stage)
    return [*_names(stages, _table(plain, "rotors")), *_references(everyone, plain), *faults]


def too_many(plain: Mapping[str, Any]) -> Iterator[str]:
    """List tables of a raw scene with more entries than any drive train; the first check."""
    stages = [stage for stage in _table(plain, "stages").values() if isinstance(stage, dict)]
    planets = [n for n in (stage.get("planets") for stage in stages) if isinstance(n, int) and 0 < n <= MOST_PLANETS]
    others = [len(PARTS.get(str(stage.get("kind")), ())) for stage in stages]
    count = len(_table(plain, "rotors")) + sum(planets) + sum(others)
    if count > MOST_MEMBERS:
        yield f"stages and rotors: {count} members, planets included; join some, {MOST_MEMBERS} at most"
    for key in ("couplings", "loads"):
        if len(_table(plain, key)) > MOST_MEMBERS:
            yield f"{key}: has {len(_table(plain, key))} entries; leave out some, {MOST_MEMBERS} at most"


def _table(plain: Mapping[str, Any], key: str) -> dict[str, Any]:
    """Return a table of the raw scene, empty if it is not a table."""
    table = plain.get(key)
    return table if isinstance(table, dict) else {}


def _names(stages: Mapping[str, object], rotors: Mapping[str, object]) -> Iterator[str]:
    """Check that names of stages and rotors are unique."""
    for name in stages:
        if name in rotors:
            yield f"rotors.{name}: a stage has this name already; choose another"
    for section, table in (("stages", stages), ("rotors", rotors)):
        for name in table:
            if name in RESERVED:
                yield f"{section}.{name}: ltcgear uses this name itself; choose another"


def _references(everyone: Mapping[str, Member | Rotor | None], plain: Mapping[str, Any]) -> Iterator[str]:
    """Check the names in loads and couplings; ``everyone`` has None for a malformed member."""
    known = [name for name in everyone if not name.endswith(".planet")]
    used: list[tuple[str, object]] = []
    for key, load in _table(plain, "loads").items():
        used.append((f"loads.{key}.member", load.get("member") if isinstance(load, dict) else None))
    for key, item in _table(plain, "couplings").items():
        ends = item.get("between") if isinstance(item, dict) else None
        ends = ends if isinstance(ends, list) else []
        used += [(f"couplings.{key}.between", name) for name in ends]
        if len(ends) == 2 and ends[0] == ends[1]:
            yield f"couplings.{key}.between: both ends are {ends[0]!r:.60}"
    for key, name in used:
        if not isinstance(name, str):
            continue
        if name not in known:
            yield f"{key}: there is no member {name!r:.60}; {suggest(name, known, 'members')}"
            continue
        member = everyone[name]
        if key.startswith("loads.") and member is not None and is_fixed(member):
            yield f'{key}: {name} has support = "fixed" and cannot be driven; free it or drop the load'


def _loads(scene: Scene) -> Iterator[str]:
    """Check that speeds are given once, and not to members that cannot rotate."""
    everyone = members(scene)
    given = [load.member for load in scene.loads.values() if load.holds or load.initial_speed is not None]
    for name in dict.fromkeys(name for name in given if given.count(name) > 1):
        yield f"loads: the speed of {name} is given twice; keep one"
    for key, load in scene.loads.items():
        turns = load.speed or load.initial_speed or load.speed_over_time
        if turns and everyone[load.member].torsional_support is not None:
            yield f"loads.{key}: {load.member} has a torsional_support and cannot turn; drop the support or the speed"
    for name, stage in scene.stages.items():
        for part in ("input", "output") if isinstance(stage, Pair) and scene.loads else ():
            if getattr(stage, part).support == "floating":
                yield f"stages.{name}.{part}: nothing holds a floating gear of a pair under load; give it a bearing"


def _stage(name: str, stage: Planetary | Pair) -> Iterator[str]:
    """Check one stage: tooth system, centre distance, meshes, assembly, support."""
    key = f"stages.{name}"
    parts = ("ring", "sun", "planet") if isinstance(stage, Planetary) else ("input", "output")
    wheels = {part: getattr(stage, part) for part in parts}
    faults = list(_tooth_system(key, stage, wheels))
    if not faults and isinstance(stage, Planetary):
        faults = list(_sizes(key, stage))
    faults = faults or list(_centre_distance(key, stage))
    if not faults:
        for mesh_name, mesh, one, two, sigma in meshes(stage):
            faults += _mesh(f"{key}.{mesh_name}", stage, mesh, one, two, sigma)
        faults += oversized(key, stage, meshes(stage))
        if isinstance(stage, Planetary):
            faults += _support(key, stage)
            faults += [*_assembly(key, stage), *(_room(key, stage) if not faults else ())]
    yield from faults


def meshes(stage: Planetary | Pair) -> list[tuple[str, Mesh, Gear, Gear, int]]:
    """Return the meshes of a stage: name, mesh, gear 1, gear 2, sign of the pair."""
    if isinstance(stage, Pair):
        return [("mesh", stage.mesh, stage.input, stage.output, 1)]
    return [
        ("sun_planet", stage.sun_planet, stage.sun, stage.planet, 1),
        ("ring_planet", stage.ring_planet, stage.ring, stage.planet, -1),
    ]


def _tooth_system(key: str, stage: Stage, wheels: dict[str, Gear]) -> Iterator[str]:
    """Check that radii can be computed."""
    if stage.pressure_angle is not None and not 0.0 < stage.pressure_angle < 0.8:
        yield f"{key}.pressure_angle: must lie between 0 and 45 deg"
    if not -0.8 < stage.helix_angle < 0.8:
        yield f"{key}.helix_angle: must lie between -45 and 45 deg"
    if (stage.module is None) != (stage.pressure_angle is None):
        absent, present = ("module", "pressure_angle") if stage.module is None else ("pressure_angle", "module")
        yield f"{key}.{absent}: is missing; the teeth need it beside {present}"
        return
    toothed = stage.module is not None
    for part, gear in wheels.items():
        if gear.tooth_thinning < 0:
            yield f"{key}.{part}.tooth_thinning: must not be less than zero"
        if gear.tooth_thinning and not toothed:
            yield f"{key}.{part}.tooth_thinning: needs the stage's module and pressure_angle; give the mesh's backlash"
        if gear.base_radius is None and (gear.teeth is None or not toothed):
            yield f"{key}.{part}: give teeth (with the stage's module and pressure_angle) or base_radius"
        if gear.base_radius is not None and gear.teeth is not None and toothed:
            due = gear_geometry.base_radius(stage, gear.model_copy(update={"base_radius": None}))
            if abs(due - gear.base_radius) > 1e-3 * due:
                yield f"{key}.{part}.base_radius: teeth and module give {due * 1e3:.6g} mm; drop one of them"


def _sizes(key: str, stage: Planetary) -> Iterator[str]:
    """Check that the ring is larger than a planet."""
    ring, planet = gear_geometry.base_radius(stage, stage.ring), gear_geometry.base_radius(stage, stage.planet)
    if ring <= planet * (1 + 1e-9):
        yield f"{key}.ring: must be larger than the planet; base radii are {ring * 1e3:.6g} and {planet * 1e3:.6g} mm"


def _centre_distance(key: str, stage: Planetary | Pair) -> Iterator[str]:
    """Check that there is one centre distance, consistent with the teeth."""
    if stage.center_distance is not None:
        return
    wheels = [gear for _, _, *pair, _ in meshes(stage) for gear in pair]
    if stage.module is None or not all(gear.teeth for gear in wheels):
        yield f"{key}.center_distance: is missing; it follows from teeth only with module and pressure_angle"
        return
    distances = {}
    for name, _, one, two, sigma in meshes(stage):
        if not gear_geometry.working_involute(stage, one, two, sigma) > 1e-9:
            yield f"{key}.{name}: the profile shifts leave no working pressure angle; give larger ones"
            return
        distances[name] = gear_geometry.standard_centre_distance(stage, one, two, sigma) * 1e3
    if len(distances) == 2 and abs(distances["sun_planet"] - distances["ring_planet"]) > 1e-6 * distances["sun_planet"]:
        yield (
            f"{key}.center_distance: teeth and profile shifts give {distances['sun_planet']:.3f} mm for sun-planet but "
            f"{distances['ring_planet']:.3f} mm for ring-planet; let the profile shifts agree, or give center_distance"
        )


def _mesh(key: str, stage: Planetary | Pair, mesh: Mesh, one: Gear, two: Gear, sigma: int) -> Iterator[str]:
    """Check one mesh: base circles, reference gear, contact ratio."""
    r1, r2, distance = (
        gear_geometry.base_radius(stage, one),
        gear_geometry.base_radius(stage, two),
        gear_geometry.stage_distance(stage),
    )
    base = r1 + sigma * r2
    if not 0 < base < distance:
        kind = "sum" if sigma > 0 else "difference"
        yield (
            f"{key}: the base circles' {kind} {base * 1e3:.3f} mm must lie between 0 and the centre distance "
            f"{distance * 1e3:.3f} mm; check teeth, module and center_distance"
        )
        return
    if base < distance * cos(pi / 4):
        yield (
            f"{key}: the centre distance {distance * 1e3:.3f} mm makes the working pressure angle "
            f"{degrees(acos(base / distance)):.1f} deg, above 45; check teeth, module and center_distance"
        )
        return
    if one.teeth and two.teeth and abs(r1 * two.teeth / (r2 * one.teeth) - 1) > 1e-3:
        yield f"{key}: base radii and teeth of its gears are not in one ratio; drop base_radius or teeth"
    choices = tuple(key.rsplit(".", 1)[-1].split("_")) if isinstance(stage, Planetary) else ("input", "output")
    if mesh.reference is not None and mesh.reference not in choices:
        yield f"{key}.reference: must be one of {', '.join(choices)}, not {mesh.reference!r}"
        return
    faults: list[str] = []
    if mesh.face_width is not None:
        faults += _computable(key, stage, mesh, one, two)
    elif mesh.double_factor is not None or mesh.tooth_errors:
        faults += _contact_ratio(key, stage, mesh, one, two, sigma)
    faults = faults or [*_profile(key, (stage, mesh, one, two, sigma))]
    yield from [*faults, *_tooth_errors(key, stage, mesh, choices, (one, two))]


def _profile(key: str, geometry: tuple[Planetary | Pair, Mesh, Gear, Gear, int]) -> Iterator[str]:
    """Check that transitions fit into the pitch and that a table's harmonics give a positive stiffness."""
    mesh = geometry[1]
    single, double = mesh_stiffness.levels(*geometry)
    if double is not None:
        share = gear_geometry.single_share(*geometry)
        room = min(share, 1 - share)
        if mesh.transition is not None and mesh.transition > room * (1 + 1e-9):
            yield f"{key}.transition: transitions overlap, single contact lasts {share:.3f} pitches; {room:.3f} at most"
        levels = partial(mesh_stiffness.two_level_series, single, double, share)
        yield from _positive(f"{key}.harmonics", mesh.harmonics, levels)
    if mesh.stiffness_table is not None:
        table = partial(mesh_stiffness.table_series, mesh.stiffness_table)
        yield from _positive(f"{key}.stiffness_table", mesh.harmonics, table)


def _positive(key: str, count: int, series: Callable[[int], list[float]]) -> Iterator[str]:
    """Check that a series with a number of harmonics is positive over the whole pitch."""
    least = mesh_stiffness.least_value(tuple(series(count)))
    if least <= 0:
        lawful = mesh_stiffness.lawful_counts(series(MOST_HARMONICS))
        near = min(lawful, key=lambda n: abs(n - count), default=0)
        cure = f"give harmonics = {near}" if near else "no number of them stays above zero, so smooth the table"
        yield f"{key}: {count} harmonics swing down to {least:.3g} N/m; {cure}"


def _tooth_errors(
    key: str, stage: Planetary | Pair, mesh: Mesh, parts: tuple[str, ...], wheels: tuple[Gear, Gear]
) -> Iterator[str]:
    """Check that the teeth with errors exist."""
    named = [(item.gear, item.tooth, item.planet) for item in mesh.tooth_errors]
    for number, item in enumerate(mesh.tooth_errors):
        where = f"{key}.tooth_errors.{number}"
        if named[number] in named[:number]:
            yield f"{where}: tooth {item.tooth} of the {item.gear} is given twice; keep one"
        if item.gear not in parts:
            yield f"{where}.gear: must be one of {', '.join(parts)}, not {item.gear!r}"
            continue
        teeth = wheels[parts.index(item.gear)].teeth
        if teeth is not None and item.tooth >= teeth:
            yield f"{where}.tooth: the {item.gear} has teeth 0 to {teeth - 1}"
        if item.planet is not None and not (isinstance(stage, Planetary) and item.planet <= stage.planets):
            yield f"{where}.planet: there is no planet {item.planet}; leave it out to mean all"


def _computable(key: str, stage: Planetary | Pair, mesh: Mesh, one: Gear, two: Gear) -> Iterator[str]:
    """Check that the stiffness can be computed from the teeth."""
    if stage.module is None or one.teeth is None or two.teeth is None:
        yield f"{key}.face_width: needs teeth, module and pressure_angle; give stiffness instead"
    elif stage.helix_angle:
        yield f"{key}.face_width: only the stiffness of spur gears is computed; give stiffness for helical ones"
    elif mesh.contact_ratio is not None:
        yield f"{key}.contact_ratio: follows from the teeth beside face_width; drop one of them"
    else:
        sigma = -1 if key.endswith("ring_planet") else 1
        yield from _contact_ratio(key, stage, mesh, one, two, sigma)


def _contact_ratio(key: str, stage: Planetary | Pair, mesh: Mesh, one: Gear, two: Gear, sigma: int) -> Iterator[str]:
    """Check that single and double contact can alternate."""
    if one.teeth is None or two.teeth is None:
        yield f"{key}: double_factor and tooth_errors need the teeth of both gears; give them, or drop these"
        return
    if mesh.contact_ratio is not None:
        if mesh.tooth_errors and mesh.contact_ratio in (1.0, 2.0):
            yield f"{key}.contact_ratio: tooth_errors are handed over in double contact; give one between 1 and 2"
        return
    if stage.module is None:
        yield f"{key}.contact_ratio: is missing; without module and pressure_angle it cannot be computed"
        return
    distance = gear_geometry.stage_distance(stage)
    ratio = gear_geometry.contact_ratio(stage, one, two, sigma, distance)
    cure = "give contact_ratio" + (", or drop double_factor" if mesh.double_factor else "")
    if not 1 < ratio < 2:
        yield f"{key}.contact_ratio: full-depth teeth would have {ratio:.3f}, outside 1 to 2; {cure}"
    elif gear_geometry.interference(stage, one, two, sigma, distance):
        yield f"{key}.contact_ratio: full-depth tips would cut into the flanks below the base circle; {cure}"


def _sliding(name: str, stage: Planetary | Pair, friction: str) -> Iterator[str]:
    """Check that sliding friction has its contacts: between the base circles, one or two pairs."""
    for mesh_name, mesh, one, two, sigma in meshes(stage):
        key = f"stages.{name}.{mesh_name}"
        if friction != "sliding" or mesh.friction is None:
            continue
        if stage.module is None or one.teeth is None or two.teeth is None:
            yield f"{key}.friction: sliding needs the teeth of both gears, module and pressure_angle; give them"
            continue
        ratio = 2.0 - gear_geometry.single_share(stage, mesh, one, two, sigma)
        at, ends = (
            gear_geometry.mesh_geometry(stage, one, two, sigma),
            gear_geometry.path_of_contact(stage, one, two, sigma),
        )
        half, middle = ratio * pi * at.r1 / one.teeth, sum(ends) / 2
        on_one, on_two = sigma * middle + at.r1 * tan(at.alpha), at.r2 * tan(at.alpha) - middle
        if mesh.contact_ratio in (1.0, 2.0):
            yield f"{key}.contact_ratio: sliding friction goes from one pair of teeth to two; give one between 1 and 2"
        elif not 1 < ratio < 2:
            yield f"{key}.contact_ratio: full-depth teeth would have {ratio:.3f}, outside 1 to 2; give contact_ratio"
        elif min(on_one, on_two) < half:
            yield f"{key}.contact_ratio: {ratio:.3f} leads the teeth's contact past a base circle; give a smaller one"


def _room(key: str, stage: Planetary) -> Iterator[str]:
    """Check that neighbouring planets do not collide, at least not at their base circles."""
    around = sorted(angle % tau for angle in planet_angles(stage))
    gaps = [two - one for one, two in pairwise([*around, around[0] + tau])]
    room = 2 * gear_geometry.stage_distance(stage) * abs(cos((pi - min(gaps)) / 2))
    width = 2 * gear_geometry.base_radius(stage, stage.planet)
    if stage.planets > 1 and room <= width:
        yield (
            f"{key}.{'planets' if stage.planet_angles is None else 'planet_angles'}: neighbouring planets overlap, "
            f"{room * 1e3:.3f} mm apart with base circles of {width * 1e3:.3f} mm; take fewer planets"
        )


def _assembly(key: str, stage: Planetary) -> Iterator[str]:
    """Check that each planet meets tooth gaps of sun and ring: (z_s + z_r) (angle_i - angle_1) / 2 pi whole."""
    if stage.sun.teeth is None or stage.ring.teeth is None:
        return
    angles, teeth = planet_angles(stage), stage.sun.teeth + stage.ring.teeth
    if stage.planet_angles is None:
        if teeth % stage.planets:
            yield (
                f"{key}.planets: {stage.planets} equally spaced planets cannot be assembled, since "
                f"({stage.sun.teeth} + {stage.ring.teeth}) / {stage.planets} is not whole; give planet_angles"
            )
        return
    for i, angle in enumerate(angles):
        steps = (angle - angles[0]) * teeth / tau
        if abs(steps - round(steps)) > 0.01:
            near = degrees(angles[0] + round(steps) * tau / teeth)
            yield f'{key}.planet_angles.{i}: no teeth meet here; the nearest place is "{near:.9g} deg"'


def _support(key: str, stage: Planetary) -> Iterator[str]:
    """Check that the stage has a lateral support."""
    if stage.sun.support == stage.ring.support == stage.carrier.support == "floating":
        yield f"{key}: sun, ring and carrier all float, so nothing holds the stage; give one of them a bearing"
