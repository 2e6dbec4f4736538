"""Sensitivities of eigenfrequencies or of an output, as plain values."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from ltcgear.generated.contract import CONTINUOUS
from ltcgear.generated.errors import LtcgearError
from numpy.typing import NDArray

from ...linear.modes import find_modes
from ...linear.sensitivity import ModeDerivative, differentiate_modes
from ...linear.system import linearise
from ...model.equilibrium import find_equilibrium
from ...model.library import Library
from ...model.load_tables import Pairs
from ...model.operating_point import OperatingPoint
from ...simulation.choose_method import choose
from ...simulation.methods.registry import AUTO
from ...simulation.run_settings import RunSettings
from .adjoint import OutputDerivative, differentiate_output
from .ranking import list_influences
from .worth import check_measure, find_output

Vector = NDArray[np.float64]
OVERDAMPED = (
    "does not oscillate: what is given is the rate at which it decays or grows over 2 pi, the slower one of two"
)


def list_modes(
    library: Library, p: Vector, tables: Mapping[str, Pairs] | None = None, mode: int | None = None
) -> dict[str, Any]:
    """Return how eigenfrequencies at the loaded equilibrium follow the parameters.

    Parameters
    ----------
    library, p, tables
        Model, parameters, and its tables over time.
    mode
        Number of a mode in the list of modes; all where left out.

    Raises
    ------
    LtcgearError
        If there is no such mode, or it is a rigid-body mode.
    """
    linear = linearise(OperatingPoint(library, p, find_equilibrium(library, p, tables=tables)))
    modes = find_modes(linear)
    if mode is not None and not 1 <= mode <= len(modes):
        raise LtcgearError(f"--mode {mode}: there are {len(modes)} modes; `ltcgear modes` lists them")
    if mode is not None and modes[mode - 1].kind == "rigid":
        raise LtcgearError(f"--mode {mode}: a rigid-body mode, 0 Hz whatever the parameters; give another")
    found = differentiate_modes(linear, modes, None if mode is None else [mode])
    title = "what moves its eigenfrequencies"
    return {"title": title, "unit": "Hz", "items": [_mode(library, p, item) for item in found]}


def _mode(library: Library, p: Vector, found: ModeDerivative) -> dict[str, Any]:
    """Return how one eigenfrequency follows the parameters."""
    mode, many = found.mode, f", {found.repeated} alike" if found.repeated > 1 else ""
    value = abs(mode.eigenvalue) / (2 * np.pi)
    notes = [OVERDAMPED] if mode.eigenvalue.imag == 0 else []
    beside = {"damping": found.damping_ratio} if not notes else {}
    rows = list_influences(library.manifest, p, value, found.frequency_hz, beside)
    return {
        "name": f"mode {found.number} ({mode.kind}{many})", "mode": found.number, "unit": "Hz", "value": value,
        "damping_ratio": mode.damping_ratio, "class": mode.kind, "repeated": found.repeated, "notes": notes,
        "influences": [row.to_json() for row in rows],
    }  # fmt: skip


def list_output(
    library: Library, p: Vector, tables: Mapping[str, Pairs] | None, output: str, *, measure: str,
    window: tuple[float, float], method: str, rtol: float,
) -> dict[str, Any]:  # fmt: skip
    """Return how a measure of an output of a simulation follows the parameters.

    Parameters
    ----------
    library, p, tables
        Model, parameters, and its tables over time.
    output
        QUANTITY:ITEM.
    measure
        See ``worth.MEASURES``.
    window
        First and last instant that count [s]; the run ends with the last.
    method, rtol
        See ``simulate``.

    Raises
    ------
    LtcgearError
        If there is no such output or measure, or it has no derivative.
    SolverError
        If the run or its adjoint cannot be followed.
    """
    start, end = window
    check_measure(measure, start, end)
    place = find_output(library.manifest, output)
    point = OperatingPoint(library, p, find_equilibrium(library, p, tables=tables))
    settings = RunSettings(end, method=method, rtol=rtol, tables=tables)
    chosen = choose(point, settings).method if method == AUTO else method
    found = differentiate_output(point, place, replace(settings, method=chosen), measure=measure, start=start)
    unit, rows = library.manifest.reports[place].unit, list_influences(library.manifest, p, found.value, found.gradient)
    item = {
        "name": f"{measure} of {output}, {start:g} to {end:g} s", "unit": unit, "value": found.value,
        "method": chosen, "pieces": found.pieces, "steps": found.steps, "notes": _notes(library, found),
        "one_sided": _one_sided(library, found),
        "influences": [row.to_json() for row in rows],
    }  # fmt: skip
    return {"title": f"what moves the {measure} of {output}", "unit": unit, "items": [item]}


def _one_sided(library: Library, found: OutputDerivative) -> list[str]:
    """Return the parameters whose derivatives hold to one side only."""
    return [name for name in found.one_sided if library.manifest.roles[name] in CONTINUOUS]


def _notes(library: Library, found: OutputDerivative) -> list[str]:
    """Say where derivatives hold to one side only."""
    sided = _one_sided(library, found)
    notes = [
        f"a jump falls on t = {t:g} s, derivatives hold to one side: move it (--from, --t-end)" for t in found.edges
    ]
    if sided:
        notes.append(f"begins on a border of its mesh, derivative for a phase that has gone on: {', '.join(sided)}")
    return notes
