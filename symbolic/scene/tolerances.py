"""Bounds of backlash and tooth errors relative to the size of the teeth.

A tooth is pi / 2 modules thick at its reference circle, and two of them work 2 modules deep. The coarsest grade of ISO
1328-1 allows pitch and profile deviations of about a tenth of a module (grade 12, from module 0.5 mm on); beyond half a
module a tooth lies in its neighbour's gap. A gap, or an offset of the centre, of a module leaves half the working
depth, or a third of the tooth. Larger values indicate a wrong unit.
"""

from collections.abc import Iterator, Sequence

from ..gears import gear_geometry
from ..schema.mesh_schema import Mesh
from ..schema.scene_schema import PARTS, Gear, Pair, Planetary

OF_DISTANCE = 0.05
"""Largest ratio of a gap or an error to the centre distance."""
ERROR, GAP = 0.5, 1.0
"""Largest ratios to the module: of an error along the line of action, and of a gap or an offset of a centre."""
FEWEST = 6
"""Teeth assumed for a gear with only a base radius: few, hence large teeth."""
Places = Sequence[tuple[str, Mesh, Gear, Gear, int]]


def oversized(key: str, stage: Planetary | Pair, meshes: Places) -> Iterator[str]:
    """List gaps and errors of a stage that are too large, and negative gaps."""
    module, name_of_it = tooth_size(stage, meshes)
    distance = OF_DISTANCE * gear_geometry.stage_distance(stage)
    sizes = [(name, size, ERROR) for name, size in _errors(meshes)]
    sizes += [(name, size, GAP) for name, size in _gaps(stage, meshes)]
    for name, size, share in sizes:
        most = min(share * module, distance)
        if abs(size) > most:
            why = f"{OF_DISTANCE:g} of the centre distance" if most == distance else f"{share:g} of {name_of_it}"
            yield f"{key}.{name}: {size * 1e3:.4g} mm is no small error; {most * 1e3:.4g} mm at most, {why}"
        if size < 0 and name.endswith(("backlash", "radius")):
            yield f"{key}.{name}: must not be less than zero"


def tooth_size(stage: Planetary | Pair, meshes: Places) -> tuple[float, str]:
    """Return the module [m], or its substitute if unknown, and its name in words."""
    if stage.module is not None:
        return stage.module, "the module"
    radii = [(gear_geometry.base_radius(stage, gear), gear.teeth) for _, _, *pair, _ in meshes for gear in pair]
    pitches = [2 * radius / teeth for radius, teeth in radii if teeth]
    if pitches:
        return min(pitches), "2 base_radius / teeth"
    return min(radius for radius, _ in radii) * 2 / FEWEST, f"the module of {FEWEST} teeth on the least base_radius"


def _errors(meshes: Places) -> Iterator[tuple[str, float]]:
    """Yield flank errors along the line of action: key below the stage, size [m]."""
    for name, mesh, *_ in meshes:
        yield from ((f"{name}.tooth_errors.{i}.error", item.error) for i, item in enumerate(mesh.tooth_errors))
        error = mesh.transmission_error
        if error is not None:
            where = f"{name}.transmission_error"
            yield from ((f"{where}.amplitudes.{i}", size) for i, size in enumerate(error.amplitudes))
            if error.table is not None:
                yield f"{where}.table", max((size for _, size in error.table), key=abs)


def _gaps(stage: Planetary | Pair, meshes: Places) -> Iterator[tuple[str, float]]:
    """Yield gaps and offsets of centres: key below the stage, size [m]."""
    for name, mesh, *_ in meshes:
        yield f"{name}.backlash", mesh.backlash
    for part in (*PARTS[stage.kind], *(("planet",) if isinstance(stage, Planetary) else ())):
        gear = getattr(stage, part)
        if isinstance(gear, Gear):
            yield f"{part}.tooth_thinning", gear.tooth_thinning
            if gear.eccentricity is not None:
                yield f"{part}.eccentricity.radius", gear.eccentricity.radius
        if gear.bearing is not None and gear.bearing.clearance is not None:
            yield f"{part}.bearing.clearance", gear.bearing.clearance
    if isinstance(stage, Planetary):
        yield "pin.clearance", stage.pin.clearance or 0.0
        yield from ((f"eccentricities.{i}.radius", item.radius) for i, item in enumerate(stage.eccentricities))
        for i, item in enumerate(stage.position_errors):
            yield from ((f"position_errors.{i}.{axis}", getattr(item, axis)) for axis in ("radial", "tangential"))
