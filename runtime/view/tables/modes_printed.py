"""Terminal output of modes."""

from collections.abc import Mapping

from ...linear.naming import sum_by
from ...results.terminal import Terminal, plain, say
from .printed import Data, new_table

MOST = 2
"""Members that are told of each mode."""


def modes(data: Data, labels: Mapping[str, str]) -> None:
    """Print eigenfrequencies and what moves, by label. JSON and CSV have the shares of all members."""
    title = f"Eigenfrequencies at the loaded equilibrium, meshes {data['meshes']}"
    table = new_table(title, ">", ">Hz", ">damping", "class", "what it is", "kinetic energy")
    for column in table.columns[:3]:
        column.no_wrap = True
    for k, item in enumerate(data["modes"], start=1):
        table.add_row(*_row(k, item, labels))
    console = Terminal()
    console.print(table)
    if data["lowest"] and len(data["modes"]) < data["freedoms"]:
        console.print(f"the lowest {len(data['modes'])} of {data['freedoms']} freedoms' modes; --count N lists more")
    for file in data.get("files", []):
        say(f"wrote {file}")


def _row(k: int, item: Data, labels: Mapping[str, str]) -> tuple[str, ...]:
    """Return the cells of one mode."""
    return (
        str(k),
        f"{item['frequency_hz']:.2f}",
        f"{round(item['damping_ratio'], 4) + 0.0:.2%}",
        item["class"] + (f" x{item['multiplicity']}" if item["multiplicity"] > 1 else ""),
        plain(item["name"]),
        plain(_largest(sum_by(item["members"], labels))),
    )


def _largest(shares: dict[str, float]) -> str:
    """Write the largest shares."""
    some = [(name, share) for name, share in shares.items() if share > 0.005]
    return ", ".join(f"{name} {share:.0%}" for name, share in some[:MOST])
