"""Tables of an accuracy record."""

from typing import Any

from ...results.table import Cell, Table
from ...studies.accuracy.reference import MARGIN
from ...studies.accuracy.run_errors import KINDS, value_of

Data = dict[str, Any]
HEADINGS = {"mesh_force": "mesh", "transmission_error": "TE", "load_share": "share", "spectrum": "dB"}
"""Kinds that are shown, by their short names; the record has all."""


def make_tables(record: Data) -> list[Table]:
    """Return what was measured, the cheapest settings, and the phases."""
    tables = [_points(record), _best(record)]
    return [*tables, _phases(record)] if (record["phases"] or {}).get("cold") else tables


def _points(record: Data) -> Table:
    """List errors and times of all points."""
    title = f"Accuracy of {record['scene']} over {record['t_end']:g} s"
    columns = ("method", "rtol", *HEADINGS.values(), "s/s", "ns/rhs", "runs")
    rows = tuple(_row(record, point) for point in record["points"] if point["reason"] is None)
    return Table(title, columns, rows, (*_gaps(record), *_notes(record)))


def _row(record: Data, point: Data) -> tuple[Cell, ...]:
    """Return a point's row."""
    mark = "" if point["trusted"] else " *"
    errors = (_short(value_of(point["errors"], kind)) for kind in HEADINGS)
    return (
        point["method"], f"{_short(point['rtol'])}{mark}", *errors, f"{point['seconds'] / record['t_end']:.3g}",
        f"{point['ns_call']:.0f}", str(point["rounds"] or 1),
    )  # fmt: skip


def _short(value: float | None) -> str:
    """Write an error or a tolerance in few letters, as 1.7e-9."""
    return "-" if value is None else f"{value:.1e}".replace("e-0", "e-")


def _gaps(record: Data) -> list[str]:
    """Say what did not run and why, equal reasons of a method once."""
    grouped: dict[tuple[str, str], list[str]] = {}
    for point in record["points"]:
        if point["reason"]:
            grouped.setdefault((point["method"], point["reason"]), []).append(_short(point["rtol"]))
    return [f"{method} at rtol {', '.join(rtols)}: {reason}" for (method, reason), rtols in grouped.items()]


def _notes(record: Data) -> list[str]:
    """Say what the errors are, and what the reference is worth."""
    reference = record["reference"]
    notes = [
        "mesh, TE: mesh force and dynamic transmission error, rms over the vibration; share: planets' load share; "
        "dB: lines of mesh forces at mesh orders; the worst element each, bearings and states are in --json.",
        f"s/s: seconds of the integrator a simulated second; a right-hand side alone takes {record['ns_rhs']:.0f} ns.",
        *record["notes"],
        f"--method auto takes {record['auto']}.",
    ]
    if reference["reason"] is not None:
        return [f"No errors: {reference['reason']}", *reference["failures"], *notes]
    runs = " and ".join(f"{run['method']} at rtol {run['rtol']:g}" for run in reference["runs"])
    differ = value_of(reference["uncertainty"], record["measure"])
    notes.append(f"Reference: {runs}, which differ by {_short(differ)}; uncertain by {_short(reference['floor'])}.")
    if reference["exact"] is not None:
        exact = value_of(reference["exact"], record["measure"])
        notes.append(f"The first of them is {_short(exact)} off the exact motion, by matrix exponentials.")
    if not all(point["trusted"] for point in record["points"] if point["reason"] is None):
        notes.append(f"*: error below {MARGIN:g} times that, so not known to 1 %.")
    return notes


def _best(record: Data) -> Table:
    """List the cheapest settings."""
    title = f"Cheapest setting, by {KINDS.get(record['measure'], 'no measure')}"
    rows = tuple(
        (f"{100 * e['error']:g} %", e["method"] or "none", _short(e["rtol"]), _short(e["found"]), e["real_time_factor"])
        for e in record["best"]
    )
    return Table(title, ("error", "method", "rtol", "found", "times real time"), rows)


def _phases(record: Data) -> Table:
    """List the seconds of the phases."""
    cold, warm = (record["phases"][run] for run in ("cold", "warm"))
    rows = tuple((name, round(cold[name], 3), round(warm[name], 3)) for name in cold)
    return Table("Seconds of one run by phase", ("phase", "from nothing", "from the store"), rows)
