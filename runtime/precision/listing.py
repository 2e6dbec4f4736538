"""Listing: a record as tables for people."""

from typing import Any

from ..tables import Cell, Table
from .errors import KINDS, value_of
from .reference import MARGIN

Data = dict[str, Any]
HEADINGS = ("mesh", "bearing", "TE", "share", "dB", "states")
"""Short names of ``KINDS``, in order."""


def make_tables(record: Data) -> list[Table]:
    """Return what was measured, the cheapest settings, and the phases."""
    tables = [_points(record), _best(record)]
    return [*tables, _phases(record)] if (record["phases"] or {}).get("cold") else tables


def _points(record: Data) -> Table:
    """List errors and times of all points."""
    title = f"Accuracy of {record['scene']} over {record['t_end']:g} s"
    columns = ("method", "rtol", *HEADINGS, "s/s", "rhs/s", "ns/rhs", "runs")
    rows = tuple(_row(record, point) for point in record["points"] if point["reason"] is None)
    return Table(title, columns, rows, (*_gaps(record), *_notes(record)))


def _row(record: Data, point: Data) -> tuple[Cell, ...]:
    """Return a point's row."""
    mark = "" if point["trusted"] else " *"
    errors = (_short(value_of(point["errors"], kind)) for kind in KINDS)
    pace = point["seconds"] / record["t_end"], point["counts"]["rhs"] / record["t_end"]
    return (
        point["method"], f"{point['rtol']:.1e}{mark}", *errors, f"{pace[0]:.3g}", f"{pace[1]:.2e}",
        f"{point['ns_call']:.0f}", point["rounds"] or 1,
    )  # fmt: skip


def _short(value: float | None) -> str:
    """Write an error."""
    return "-" if value is None else f"{value:.1e}"


def _gaps(record: Data) -> list[str]:
    """Say what did not run and why, equal reasons of a method once."""
    grouped: dict[tuple[str, str], list[str]] = {}
    for point in record["points"]:
        if point["reason"]:
            grouped.setdefault((point["method"], point["reason"]), []).append(f"{point['rtol']:.1e}")
    return [f"{method} at rtol {', '.join(rtols)}: {reason}" for (method, reason), rtols in grouped.items()]


def _notes(record: Data) -> list[str]:
    """Say what the errors are, and what the reference is worth."""
    reference = record["reference"]
    notes = [
        "mesh, bearing, TE: force or dynamic transmission error, rms over its vibration; share: planets' load share; "
        "dB: lines at mesh orders; states: over the scale of vibrations; the worst element each.",
        f"s/s: seconds of the integrator a simulated second; a right-hand side alone takes {record['ns_rhs']:.0f} ns.",
        *record["notes"],
    ]
    if reference["reason"] is not None:
        return [f"No errors: {reference['reason']}", *reference["failures"], *notes]
    runs = " and ".join(f"{run['method']} at rtol {run['rtol']:g}" for run in reference["runs"])
    notes.append(f"Reference: {runs}, which differ by {reference['floor']:.1e}.")
    if not all(point["trusted"] for point in record["points"] if point["reason"] is None):
        notes.append(f"*: error below {MARGIN:g} times that, so not told to within 1 %.")
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
