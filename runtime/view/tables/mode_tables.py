"""Tables of modes: in the terminal, as JSON and as CSV."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ltcgear.generated.writing import write_rows, write_text

from ...linear.modes import Mode
from ...linear.naming import sum_by
from ...results.table import Table

MOST = 2
"""Members that are told of each mode."""


def list_modes(modes: Sequence[Mode]) -> list[dict[str, Any]]:
    """Return the modes as plain dictionaries; eigenvalues as real and imaginary part [1/s], shapes left out."""
    return [
        {
            "frequency_hz": mode.frequency_hz,
            "damping_ratio": mode.damping_ratio,
            "class": mode.kind,
            "name": mode.name,
            "group": mode.group,
            "multiplicity": mode.multiplicity,
            "eigenvalue": [mode.eigenvalue.real, mode.eigenvalue.imag],
            "energy": mode.energy,
            "members": mode.members,
            "strain": mode.strain,
        }
        for mode in modes
    ]


def write_modes(data: dict[str, Any], path: Path) -> Path:
    """Write what ``ltcgear modes --json`` prints: ``.json`` as it is, ``.csv`` as a table.

    The table has a column for the share of kinetic energy of each member and one for the share of strain energy of
    each element.
    """
    if path.suffix == ".json":
        return write_text(json.dumps(data, indent=1, allow_nan=False) + "\n", path)
    modes = data["modes"]
    shares = {
        f"{word} {name} []": (key, name)
        for word, key in (("kinetic", "members"), ("strain", "strain"))
        for name in sorted({name for mode in modes for name in mode[key]})
    }
    head = ["mode []", "frequency [Hz]", "damping ratio []", "real part [1/s]", "imaginary part [rad/s]"]
    rows: list[list[Any]] = [[*head, "class", "name", "group []", "multiplicity []", *shares]]
    for k, mode in enumerate(modes, start=1):
        numbers = [k, mode["frequency_hz"], mode["damping_ratio"], *mode["eigenvalue"]]
        kind = [mode["class"], mode["name"], mode["group"], mode["multiplicity"]]
        rows.append([*numbers, *kind, *(mode[key].get(name, 0.0) for key, name in shares.values())])
    return write_rows(rows, path)


def tabulate_modes(data: dict[str, Any], labels: Mapping[str, str]) -> list[Table]:
    """Return eigenfrequencies and what moves, by label; JSON and CSV tell the shares of all members."""
    title = f"Eigenfrequencies at the loaded equilibrium, meshes {data['meshes']}"
    columns = ("", "Hz", "damping", "class", "what it is", "kinetic energy")
    rows = tuple(_row(k, item, labels) for k, item in enumerate(data["modes"], start=1))
    few = data["lowest"] and len(rows) < data["freedoms"]
    notes = (f"the lowest {len(rows)} of {data['freedoms']} freedoms' modes; a larger count lists more",) if few else ()
    return [Table(title, columns, rows, notes)]


def _row(k: int, item: dict[str, Any], labels: Mapping[str, str]) -> tuple[str | int, ...]:
    """Return the cells of one mode."""
    return (
        k,
        f"{item['frequency_hz']:.2f}",
        f"{round(item['damping_ratio'], 4) + 0.0:.2%}",
        item["class"] + (f" x{item['multiplicity']}" if item["multiplicity"] > 1 else ""),
        item["name"],
        _largest(sum_by(item["members"], labels)),
    )


def _largest(shares: dict[str, float]) -> str:
    """Write the largest shares."""
    some = [(name, share) for name, share in shares.items() if share > 0.005]
    return ", ".join(f"{name} {share:.0%}" for name, share in some[:MOST])
