"""Table of modes as JSON and CSV."""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ltcgear.generated.writing import write_rows, write_text

from ...linear.modes import Mode


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
