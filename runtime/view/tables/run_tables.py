"""Tables of runs: mesh forces of a simulation, and what its effects cost."""

from typing import Any

from ...results.table import Table
from .scene_tables import form

Data = dict[str, Any]


def list_forces(data: Data) -> list[Table]:
    """Return the mesh forces of a run; no table where it has none."""
    rows = tuple(
        (name, *(f"{force[key]:.5g}" for key in ("mean", "min", "max")), _factor(force["load_factor"]))
        for name, force in data["forces"].items()
    )
    columns = ("mesh", "mean N", "min N", "max N", "load factor")
    return [Table("Mesh forces, second half of the run", columns, rows)] if rows else []


def _factor(factor: float) -> float | str:
    """Write a load factor."""
    return factor if factor != factor else f"{factor:.3f}"


def list_costs(data: Data) -> list[Table]:
    """Return what the variants of a scene cost, and how far their mesh forces are from the full one's."""
    costs, changes = [], []
    for item in data["variants"]:
        name = f"{item['effect']}\n  {item['value']} > {item['without']}" if item["without"] else "nothing"
        times = form(item["ns_call"], ".0f"), form(item["seconds_per_simulated_second"], ".3f")
        counts = (item["counts"].get(key) for key in ("steps", "events"))
        costs.append((name, item["states"], item["ops"]["rhs"], item["ops"]["jacobian"], *times, *counts))
        changes.append((name, *map(_change, item["changes"].values())))
    return [
        Table(
            "Cost (operations of right-hand side and Jacobian; ns a right-hand side; s a simulated s)",
            ("left out", "states", "rhs", "Jac.", "ns", "s/s", "steps", "jumps"), tuple(costs),
        ),
        Table("Change of mesh forces, worst stage", ("left out", "rms", "peak", "share", "spectrum"), tuple(changes)),
    ]  # fmt: skip


def _change(value: float | None) -> str:
    """Write a relative change; rounding has no sign."""
    return "-" if value is None else f"{value:+.2%}" if abs(value) >= 5e-5 else "0"
