"""Terminal output of campbell and response."""

from ...model.ties import order_by_size
from ...results.terminal import Terminal, plain
from .printed import Data, new_table

SHOWN = 20
"""Crossings that are printed; all are in the files."""
FEW = 5
"""Outputs of a quantity whose peaks are printed."""
SLIGHT = 1e-6
"""Share of the highest peak of a quantity below which one is not printed."""


def campbell(data: Data) -> None:
    """Print the crossings that excite most."""
    name, unit = ("speed", "rpm") if data["axis"] == "speed" else ("load", "load")
    found = data["crossings"]
    table = new_table(
        f"Orders that meet eigenfrequencies over {name}, {min(SHOWN, len(found))} of {len(found)}", "crossing",
        f">{unit}", ">Hz", ">margin", ">N per um", ">N", "class", "what it is",
    )  # fmt: skip
    modes = {mode["mode"]: mode for mode in data["modes"]}
    for item in found[:SHOWN]:
        mode = modes[item["modes"][0]]
        table.add_row(
            plain(item["crossing"]), f"{item['at']:.4g}", f"{item['frequency_hz']:.1f}", f"{item['margin']:+.0%}",
            _number(item["force_per_um"], "undamped"), _number(item["force"], "-"), mode["class"], plain(mode["name"]),
        )  # fmt: skip
    console = Terminal()
    console.print(table)
    if not data["orders"]:
        console.print("No gear that turns has teeth, so there are no orders; give teeth in place of base_radius.")
    low, high = data["values"][0], data["values"][-1]
    console.print(
        f"{len(data['modes'])} modes from {low:g} to {high:g} {data['unit']}; the scene's own is {data['home']:.5g}."
    )


def _number(value: float | None, otherwise: str) -> str:
    """Write a number, or the mark for none."""
    return otherwise if value is None else f"{value:.0f}" if value >= 100 or value == 0 else f"{value:.3g}"


def response(data: Data) -> None:
    """Print the highest peaks of the outputs that answer most."""
    micro = data["unit"] == "m"
    what = f"1 um of transmission error of {data['excited']}" if micro else f"1 N*m of ripple of {data['excited']}"
    table = new_table(
        f"Highest peaks of the response to {what}", "output", ">peak", "", ">Hz", ">mode", "class", "what it is"
    )
    for quantity in dict.fromkeys(output["quantity"] for output in data["outputs"]):
        for output in _answering(data, quantity):
            peak = output["peaks"][0]
            mode = data["modes"][peak["mode"] - 1] if peak["mode"] else {"class": "", "name": ""}
            table.add_row(
                f"{quantity} {output['item']}", _amplitude(peak, 1e-6 if micro else 1.0),
                output["unit"].split("/")[0], f"{peak['frequency_hz']:.2f}", str(peak["mode"] or ""), mode["class"],
                plain(mode["name"]),
            )  # fmt: skip
    Terminal().print(table)


def _amplitude(peak: Data, scale: float) -> str:
    """Write how high a peak is."""
    return "undamped" if peak["amplitude"] is None else f"{scale * peak['amplitude']:.4g}"


def _answering(data: Data, quantity: str) -> list[Data]:
    """Return the outputs of a quantity that have the highest peaks; those that hardly answer are left out."""
    told = [output for output in data["outputs"] if output["quantity"] == quantity and output["peaks"]]
    order = order_by_size([max(output["amplitude"]) for output in told], [output["item"] for output in told])
    told = [told[k] for k in order]
    return [output for output in told[:FEW] if max(output["amplitude"]) > SLIGHT * max(told[0]["amplitude"])]
