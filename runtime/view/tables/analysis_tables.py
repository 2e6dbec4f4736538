"""Tables of a survey."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from ...analysis.band import RAW, Band
from ...analysis.lines import Clues, NamedLine
from ...analysis.spectrum import Spectrum
from ...analysis.survey import Seen, Survey
from ...analysis.trace import FloatArray
from ...results.select import split_output
from ...results.table import Cell, Table

MICRO, KILO = 1e-6, 1e3
EXPONENT = 6.0
"""Slope of the S-N curve for the equivalent range; assumed, of the order of that of gear steels."""
Rows = list[tuple[Cell, ...]]


def list_tables(found: Survey) -> dict[str, Table]:
    """Return the tables of a survey by name; those that would be empty are left out."""
    tables = {}
    for quantity in dict.fromkeys(split_output(seen.output)[0] for seen in found.seen):
        own = [seen for seen in found.seen if split_output(seen.output)[0] == quantity]
        tables[f"lines-{quantity}"] = _lines(quantity, own, found.clues)
        tables[f"orders-{quantity}"] = _orders(quantity, own)
        tables[f"envelope-{quantity}"] = _envelopes(quantity, own)
        tables[f"sidebands-{quantity}"] = _sidebands(quantity, own)
    tables |= {
        "forces": _forces(found),
        "shares": _shares(found),
        "transmission": _transmission(found),
        "durations": _durations(found),
        "rainflow": _rainflow(found),
        "bearings": _bearings(found),
        "orbits": _orbits(found),
    }
    return {name: table for name, table in tables.items() if table.rows}


def _item(seen: Seen) -> str:
    """Return the item of an output."""
    return split_output(seen.output)[1]


def _lines(quantity: str, own: list[Seen], clues: Clues) -> Table:
    """List the strongest lines over frequency of the outputs of a quantity."""
    rows: Rows = [(_item(seen), *_named(line), line.mode or None) for seen in own for line in seen.lines]
    columns = ("output", "Hz", f"amplitude {own[0].spectrum.unit}", "kind", "name", "mode near")
    used = sorted(
        {line.mode for seen in own for line in seen.lines if line.mode}, key=lambda name: int(name.split()[1])
    )
    notes = [*_taken(own[0].spectrum, "Hz"), _limit(clues.band), *(f"{name}: {clues.words[name]}" for name in used)]
    return Table(f"Strongest lines of {quantity}", columns, tuple(rows), tuple(notes))


def _limit(band: Band) -> str:
    """Say how far lines are told, and what they are worth."""
    return f"lines up to {band.end_hz:.5g} Hz" + (f"; {RAW}" if band.raw else ", the band of the samples")


def _named(line: NamedLine) -> tuple[Cell, ...]:
    """Return a line as cells."""
    return line.place, line.amplitude, line.kind or None, line.name or None


def _taken(spectrum: Spectrum, unit: str) -> Iterator[str]:
    """Say with which window a spectrum was taken, and what it tells apart."""
    yield (
        f"{spectrum.window} window over {spectrum.start_s:.4g} to {spectrum.stop_s:.4g} s: bins "
        f"{spectrum.resolution:.3g} {unit} apart, noise bandwidth {spectrum.bandwidth:.3g} {unit}"
    )


def _orders(quantity: str, own: list[Seen]) -> Table:
    """List the strongest lines over the turns of shafts."""
    turning = [(seen, seen.orders) for seen in own if seen.orders is not None]
    rows: Rows = [(_item(seen), over.shaft, *_named(line)) for seen, over in turning for line in seen.order_lines]
    columns = ("output", "shaft", "order", f"amplitude {own[0].spectrum.unit}", "kind", "name")
    notes = [note for over in {over.shaft: over for _, over in turning}.values() for note in _turned(over)]
    return Table(f"Strongest orders of {quantity}: cycles in a turn of the shaft", columns, tuple(rows), tuple(notes))


def _envelopes(quantity: str, own: list[Seen]) -> Table:
    """List the strongest lines of envelopes: how often what lies in a band swells and fades."""
    rows: Rows = [
        (_item(seen), f"{seen.envelope.low_hz:.5g} to {seen.envelope.high_hz:.5g}", *_named(line))
        for seen in own
        for line in seen.envelope_lines
    ]
    columns = ("output", "band Hz", "Hz", f"amplitude {own[0].spectrum.unit}", "kind", "name")
    notes = tuple(_taken(own[0].envelope.spectrum, "Hz"))
    return Table(f"Strongest lines of the envelope of {quantity}", columns, tuple(rows), notes)


def _turned(spectrum: Spectrum) -> Iterator[str]:
    """Say over which turns an order spectrum was taken."""
    for note in _taken(spectrum, "orders"):
        yield f"{spectrum.shaft}: {note}"


def _sidebands(quantity: str, own: list[Seen]) -> Table:
    """List the first sidebands about mesh harmonics."""
    rows: Rows = [
        (_item(seen), band.centre[0], band.spacing[0], band.amplitude, band.lower[0], band.upper[0], band.depth)
        for seen in own
        for band in seen.sidebands
    ]
    columns = ("output", "about", "at turns of", f"middle {own[0].spectrum.unit}", "below", "above", "depth")
    notes = (
        "Amplitudes of the first pair, 0 where there is no peak; "
        "depth: that of the modulation, their sum over the middle.",
    )
    return Table(f"Sidebands of {quantity} about mesh harmonics", columns, tuple(rows), notes)


def _forces(found: Survey) -> Table:
    """List mean, extremes and factors of the mesh forces."""
    shares = {mesh: float(share.mean[k]) for share in found.shares for k, mesh in enumerate(share.meshes)}
    rows: Rows = [
        (mesh, *(one[key] / KILO + 0.0 for key in ("mean", "min", "max", "rms")), one["load_factor"], shares.get(mesh))
        for mesh, one in found.forces.items()
    ]
    columns = ("mesh", "mean kN", "min kN", "max kN", "rms kN", "max/mean", "share")
    notes = (
        "max/mean: the paper's load factor; what K_v of ISO 6336-1 is meant for, but read from this run.",
        "share: mean force over the mean of the group's planets.",
    )
    return Table("Mesh forces (normal)", columns, tuple(rows), notes)


def _shares(found: Survey) -> Table:
    """List how planets share their load."""
    rows: Rows = [(one.group, len(one.meshes), one.mesh_load_factor, one.largest) for one in found.shares]
    columns = ("group", "planets", "mesh load factor", "largest share")
    notes = (
        "Mesh load factor: largest of the planets' mean shares, what K_gamma of ISO 6336-1 is meant for.",
        "Largest share: at any time.",
    )
    return Table("Load sharing", columns, tuple(rows), notes)


def _transmission(found: Survey) -> Table:
    """List transmission errors."""
    rows: Rows = []
    for one in found.errors:
        sizes = (one.mean, one.peak_to_peak, one.vibration, *one.harmonics[:2])
        rows.append((one.mesh, one.definition, *(size / MICRO for size in sizes)))
    columns = ("mesh", "by", "mean um", "p-p um", "std um", "1st um", "2nd um")
    notes = (
        "By deflection of the teeth, or by the gears' angles, which takes in errors of teeth and what bearings yield.",
        "p-p: peak to peak; 1st, 2nd: amplitudes of mesh harmonics.",
    )
    return Table("Transmission error on the line of action", columns, tuple(rows), notes)


def _durations(found: Survey) -> Table:
    """List how often loads are exceeded."""
    rows: Rows = []
    for one in found.durations:
        total = float(one.count.sum())
        levels = [_exceeded_by(one.exceeded / total, one.edges / KILO, part) for part in (0.01, 0.1, 0.5, 0.9)]
        rows.append((split_output(one.name)[1], total, *levels))
    columns = ("mesh", "tooth meshes", "1 % kN", "10 % kN", "50 % kN", "90 % kN")
    return Table("Load duration: force exceeded in so many of all tooth meshes", columns, tuple(rows))


def _exceeded_by(above: FloatArray, edges: FloatArray, share: float) -> float:
    """Return the load that is exceeded in a share of all cycles."""
    return float(np.interp(-share, -np.append(above, 0.0), edges))


def _rainflow(found: Survey) -> Table:
    """List rainflow counts."""
    passed = {one.name: float(one.count.sum()) for one in found.durations}
    rows: Rows = [
        (split_output(one.name)[1], one.total, one.largest / KILO,
         float(one.count[one.span > 0.5 * one.largest].sum()), passed.get(one.name),
         one.equivalent(EXPONENT, passed[one.name]) / KILO if one.name in passed else None)
        for one in found.cycles
    ]  # fmt: skip
    columns = ("mesh", "cycles", "largest kN", "above half", "tooth meshes", "equivalent kN")
    notes = (
        "Ranges of rainflow cycles of the normal force (ASTM E1049); above half: cycles of more than half the largest.",
        f"Equivalent: the range that does the same damage once a tooth mesh, (sum n r^m / n_ref)^(1/m), n_ref tooth "
        f"meshes of the span and slope m = {EXPONENT:g} of the S-N curve.",
        "These are cycles of the force, not of a tooth's stress: that goes from 0 to its largest once a mesh.",
    )
    return Table("Rainflow counts", columns, tuple(rows), notes)


def _bearings(found: Survey) -> Table:
    """List bearing and pin forces."""
    rows: Rows = [
        (one.name, one.kind, *(size / KILO for size in (one.mean, one.rms, one.peak, one.vibration)))
        for one in found.bearings
    ]
    columns = ("bearing", "kind", "mean kN", "rms kN", "largest kN", "std kN")
    return Table("Forces of bearings and pins (magnitude)", columns, tuple(rows))


def _orbits(found: Survey) -> Table:
    """List the paths of members."""
    rows: Rows = []
    for one in found.orbits:
        clearance = None if one.clearance is None else one.clearance / MICRO
        sizes = (value / MICRO for value in (*one.centre, one.rms, one.largest))
        rows.append((one.member, one.held, *sizes, clearance))
    columns = ("member", "held by", "x um", "y um", "rms um", "largest um", "clearance um")
    notes = (
        "x, y: mean place in axes that turn with the stage's carrier as it is; rms and largest: distance from it.",
    )
    return Table("Paths of members", columns, tuple(rows), notes)
