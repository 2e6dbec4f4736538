"""Errors of a mesh: transmission error, single-tooth errors, pin position errors."""

from collections.abc import Iterator
from math import atan2, cos, sin, sqrt

from ltcgear.generated.contract import COUNT, GEOMETRY, SHARE

from ..gears import gear_geometry, mesh_stiffness
from ..mechanics.model import ERROR, ERROR_RATE, Profile
from ..schema.scene_schema import Planetary
from .draft import Draft, MeshPlace
from .rigid import pin_offset


def bind_error(draft: Draft, at: MeshPlace, bind: dict[str, str]) -> bool:
    """Bind the error of a mesh, if any; a law in the plane includes pin positions itself."""
    found = [*_transmission_error(draft, at), *_tooth_errors(draft, at)]
    if not at.in_plane:
        found += _misplaced(draft, at)
    draft.profiles += found
    if found:
        bind |= {"e": ERROR, "e_d": ERROR_RATE}
    return bool(found)


def _transmission_error(draft: Draft, at: MeshPlace) -> Iterator[Profile]:
    """Register the harmonics of a transmission error: A cos(x + p) = A cos(p) cos(x) - A sin(p) sin(x)."""
    error = at.mesh.transmission_error
    if error is None or not draft.on("transmission_error"):
        return
    series = [0.0] if error.table is None else mesh_stiffness.table_series(error.table, at.mesh.harmonics)
    for amplitude, phase in zip(error.amplitudes, error.phases or [0.0] * len(error.amplitudes), strict=True):
        series += [amplitude * cos(phase), -amplitude * sin(phase)]
    yield Profile(at.label, "error", "series", draft.series(f"{at.name}.transmission_error", series, "m"))


def _tooth_errors(draft: Draft, at: MeshPlace) -> Iterator[Profile]:
    """Register the teeth with spacing errors."""
    parts = ("input", "output") if at.name.endswith(".mesh") else tuple(at.name.split(".")[-1].split("_"))
    for number, item in enumerate(at.mesh.tooth_errors if draft.on("tooth_errors") else ()):
        if item.planet is not None and not at.label.endswith(f".{item.planet}"):
            continue
        teeth = at.wheels[parts.index(item.gear)].teeth
        key = f"{at.name}.tooth_error_{number}"
        share = draft.number(f"{at.name}.single_share", gear_geometry.single_share(*at.geometry), "", bounds=SHARE)
        numbers = (
            draft.number(key, item.error, "m"),
            draft.number(f"{key}.tooth", item.tooth, "", COUNT),
            draft.number(f"{key}.teeth", teeth or 0, "", COUNT),
            share,
        )
        yield Profile(at.label, "error", "tooth", numbers)


def pin_turn(draft: Draft, at: MeshPlace) -> float | None:
    """Return the rotation of the line of centres by a pin position error [rad]; None in a stage without such errors."""
    if not (isinstance(at.stage, Planetary) and draft.on("planet_position_error") and at.stage.position_errors):
        return None
    radial, tangential = pin_offset(draft.scene, at.stage, int(at.label.rsplit(".", 1)[1]))
    return atan2(tangential, gear_geometry.stage_distance(at.stage) + radial)


def _misplaced(draft: Draft, at: MeshPlace) -> Iterator[Profile]:
    """Register how a pin position error turns and opens a mesh of gears that only rotate, by the involute law."""
    stage, turn = at.stage, pin_turn(draft, at)
    if turn is None or not isinstance(stage, Planetary):
        return
    radial, tangential = pin_offset(draft.scene, stage, int(at.label.rsplit(".", 1)[1]))
    nominal = gear_geometry.mesh_geometry(stage, *at.wheels, at.sigma)
    base = nominal.r1 + at.sigma * nominal.r2
    now = sqrt((nominal.distance + radial) ** 2 + tangential**2 - base**2) / base
    opened = at.sigma * base * (now - atan2(now, 1.0) - gear_geometry.involute(nominal.alpha))
    turned = draft.parameters[f"{at.name}.flank"].value * base * turn
    yield Profile(at.label, "turned", "constant", (draft.number(f"{at.label}.turned", turned, "m", GEOMETRY),))
    yield Profile(at.label, "opening", "constant", (draft.number(f"{at.label}.opened", opened, "m", GEOMETRY),))
