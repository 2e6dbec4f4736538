"""Resonance data of the Campbell diagram and the frequency response, for JSON, tables and figures."""

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from ltcgear.generated.errors import LtcgearError
from ltcgear.generated.writing import write_rows

from ..model.members import Train
from .campbell import UNITS, Campbell
from .crossings import Crossing
from .modes import Mode
from .naming import describe_modes
from .orders import Order
from .response import UNDAMPED, Response, find_peaks

Data = dict[str, Any]
FIGURES = (".png", ".svg", ".pdf")
TABLES = (".csv", ".json")
PEAKS = 5
"""Peaks of an output that are told."""


def check_suffix(path: Path) -> None:
    """Refuse a file that is neither a figure nor a table, before anything is computed."""
    if path.suffix not in (*FIGURES, *TABLES):
        raise LtcgearError(f"{path}: name it .png, .svg or .pdf for a figure, .csv or .json for numbers")


def tell_campbell(scene: str, campbell: Campbell, orders: Sequence[Order], crossings: Sequence[Crossing]) -> Data:
    """Report modes along the axis, orders and crossings."""
    columns = range(campbell.tracks.shape[1])
    return {
        "scene": scene,
        "axis": campbell.axis,
        "unit": UNITS[campbell.axis],
        "home": campbell.home,
        "values": campbell.values.tolist(),
        "turns_per_s": np.abs(campbell.turns).tolist(),
        "orders": [asdict(order) for order in orders],
        "modes": [_tell_track(campbell, column) for column in columns],
        "crossings": [_tell_crossing(crossing) for crossing in crossings],
    }


def _tell_track(campbell: Campbell, column: int) -> Data:
    """Report a tracked mode."""
    found = [campbell.mode(i, column) for i in range(len(campbell.values))]
    point = campbell.at_home if found[campbell.at_home] else next(i for i, mode in enumerate(found) if mode)
    (known,) = describe_modes(campbell.linears[point], [mode for mode in found[point : point + 1] if mode])
    return {
        "mode": campbell.number(column),
        "class": known.kind,
        "name": known.name,
        "frequency_hz": [None if mode is None else mode.frequency_hz for mode in found],
        "damping_ratio": [None if mode is None else mode.damping_ratio for mode in found],
    }


def _tell_crossing(crossing: Crossing) -> Data:
    """Report a crossing."""
    return {
        "crossing": f"{crossing.order.name} with mode {', '.join(map(str, crossing.modes))}",
        "order": crossing.order.name,
        "modes": list(crossing.modes),
        "at": crossing.value,
        "frequency_hz": crossing.frequency_hz,
        "margin": crossing.margin,
        "mesh": crossing.mesh,
        "force_per_um": crossing.sensitivity,
        "force": crossing.force,
    }


def tell_response(scene: str, response: Response, modes: Sequence[Mode], train: Train) -> Data:
    """Report amplitudes, phases and peaks of every output; a peak without damping has no amplitude."""
    return {
        "scene": scene,
        "excited": response.excited,
        "unit": response.unit,
        "frequency_hz": response.frequency.tolist(),
        "modes": [
            {"mode": k, "frequency_hz": m.frequency_hz, "damping_ratio": m.damping_ratio, "class": m.kind,
             "name": m.name}
            for k, m in enumerate(modes, start=1)
        ],
        "outputs": [_tell_output(response, column, modes, train) for column in range(len(response.outputs))],
    }  # fmt: skip


def _tell_output(response: Response, column: int, modes: Sequence[Mode], train: Train) -> Data:
    """Report one output."""
    quantity, item, unit = response.outputs[column]
    values = response.values[:, column]
    peaks = [
        {
            "frequency_hz": float(response.frequency[i]),
            "amplitude": None if mode >= 0 and abs(modes[mode].damping_ratio) < UNDAMPED else float(abs(values[i])),
            "mode": mode + 1 or None,
        }
        for i, mode in find_peaks(response, column, modes)[:PEAKS]
    ]
    return {
        "quantity": quantity,
        "item": item,
        "group": train.group(item),
        "unit": f"{unit}/({response.unit})" if "*" in response.unit else f"{unit}/{response.unit}",
        "amplitude": np.abs(values).tolist(),
        "phase_deg": np.rad2deg(np.angle(values)).tolist(),
        "peaks": peaks,
    }


def write_campbell(data: Data, path: Path) -> None:
    """Write a row for each value of the axis: eigenfrequencies [Hz] and damping ratios of all modes."""
    names = [f"mode {m['mode']}" for m in data["modes"]]
    head = [f"{data['axis']} [{data['unit']}]", *(f"{n} [Hz]" for n in names), *(f"{n} damping ratio" for n in names)]
    columns = [
        data["values"], *(m["frequency_hz"] for m in data["modes"]), *(m["damping_ratio"] for m in data["modes"]),
    ]  # fmt: skip
    _write(path, head, columns)


def write_response(data: Data, path: Path) -> None:
    """Write a row for each frequency: amplitude and phase of all outputs."""
    head, columns = ["frequency [Hz]"], [data["frequency_hz"]]
    for output in data["outputs"]:
        name = f"{output['quantity']} {output['item']}"
        head += [f"{name} [{output['unit']}]", f"{name} phase [deg]"]
        columns += [output["amplitude"], output["phase_deg"]]
    _write(path, head, columns)


def _write(path: Path, head: list[str], columns: list[list[Any]]) -> None:
    """Write columns as CSV."""
    write_rows([head, *zip(*columns, strict=True)], path)
