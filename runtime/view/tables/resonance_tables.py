"""Tables of crossings of the Campbell diagram and of peaks of the response."""

from typing import Any

from ...model.ties import order_by_size
from ...results.table import Table

Data = dict[str, Any]

SHOWN = 20
"""Crossings that are printed; all are in the files."""
FEW = 5
"""Outputs of a quantity whose peaks are printed."""
SLIGHT = 1e-6
"""Share of the highest peak of a quantity below which one is not printed."""


def tabulate_crossings(data: Data) -> list[Table]:
    """Return the crossings that excite most."""
    name, unit = ("speed", "rpm") if data["axis"] == "speed" else ("load", "load")
    found, modes = data["crossings"], {mode["mode"]: mode for mode in data["modes"]}
    rows = tuple(
        (item["crossing"], f"{item['at']:.4g}", f"{item['frequency_hz']:.1f}", f"{item['margin']:+.0%}",
         _number(item["force_per_um"], "undamped"), _number(item["force"], "-"), mode["class"], mode["name"])
        for item, mode in ((item, modes[item["modes"][0]]) for item in found[:SHOWN])
    )  # fmt: skip
    low, high = data["values"][0], data["values"][-1]
    scope = f"{len(modes)} modes from {low:g} to {high:g} {data['unit']}; the scene's own is {data['home']:.5g}"
    none = "no gear that turns has teeth, so there are no orders; give teeth in place of base_radius"
    return [Table(
        f"Orders that meet eigenfrequencies over {name}, {len(rows)} of {len(found)}",
        ("crossing", unit, "Hz", "margin", "N per um", "N", "class", "what it is"), rows,
        (scope,) if data["orders"] else (none, scope),
    )]  # fmt: skip


def _number(value: float | None, otherwise: str) -> str:
    """Write a number, or what stands for none."""
    return otherwise if value is None else f"{value:.0f}" if value >= 100 or value == 0 else f"{value:.3g}"


def tabulate_response(data: Data) -> list[Table]:
    """Return the highest peaks of the outputs that answer most."""
    micro = data["unit"] == "m"
    what = f"1 um of transmission error of {data['excited']}" if micro else f"1 N*m of ripple of {data['excited']}"
    rows = tuple(
        _peak_row(data, output, 1e-6 if micro else 1.0)
        for quantity in dict.fromkeys(output["quantity"] for output in data["outputs"])
        for output in _answering(data, quantity)
    )
    columns = ("output", "peak", "", "Hz", "mode", "class", "what it is")
    return [Table(f"Highest peaks of the response to {what}", columns, rows)]


def _peak_row(data: Data, output: Data, scale: float) -> tuple[str, ...]:
    """Return the cells of an output's highest peak."""
    peak = output["peaks"][0]
    mode = data["modes"][peak["mode"] - 1] if peak["mode"] else {"class": "", "name": ""}
    return (
        f"{output['quantity']} {output['item']}", _amplitude(peak, scale), output["unit"].split("/")[0],
        f"{peak['frequency_hz']:.2f}", str(peak["mode"] or ""), mode["class"], mode["name"],
    )  # fmt: skip


def _amplitude(peak: Data, scale: float) -> str:
    """Write how high a peak is."""
    return "undamped" if peak["amplitude"] is None else f"{scale * peak['amplitude']:.4g}"


def _answering(data: Data, quantity: str) -> list[Data]:
    """Return the outputs of a quantity that have the highest peaks; those that hardly answer are left out."""
    told = [output for output in data["outputs"] if output["quantity"] == quantity and output["peaks"]]
    order = order_by_size([max(output["amplitude"]) for output in told], [output["item"] for output in told])
    told = [told[k] for k in order]
    return [output for output in told[:FEW] if max(output["amplitude"]) > SLIGHT * max(told[0]["amplitude"])]
