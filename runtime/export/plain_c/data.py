"""Scene data in plain C: numbers and names in ``data.c``, which defines ``ltcgear_scene``."""

import json
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain

import numpy as np
from ltcgear.generated.contract import BOUNDS, CLOSING, CONTINUOUS, PULL, VARYING, Manifest
from ltcgear.generated.errors import LtcgearError
from ltcgear.generated.store import digest

from ...model.equilibrium import Vector, find_equilibrium
from ...model.library import Library
from ...model.load_tables import Pairs, insert_zeros
from ...model.phase_wrapping import ClockNumbers, read_courses
from ...model.quantity_names import PHASES

HEAD = """/* The scene {name}: names, numbers, loaded equilibrium; written by `ltcgear generate`, see ltcgear.h. */
#include "ltcgear.h"
"""
CODES = {
    "rhs": "rhs", "jacobian": "jac_rhs", "output": "outputs", "phases": "phases", "borders": "borders",
    "energy": "energy", "motion": "motion",
}  # fmt: skip
"""Fields of the model -> functions of model.c."""
SAME = (
    "start", "tables", "signal_table", "signal_slope", "jacobian_colind", "jacobian_row", "freedoms", "clocks", "holds",
    "hold_closes", "forces",
)  # fmt: skip
"""Fields whose array has the same name."""
LARGEST = 2**62
"""Beyond all whole numbers that clocks count with."""


@dataclass(frozen=True)
class PlainRun:
    """What is simulated: parameters in SI, tables over time, time [s], samples a second [Hz]."""

    values: Mapping[str, float]
    tables: Mapping[str, Pairs]
    t_end: float
    rate: float


def write_data(library: Library, name: str, run: PlainRun) -> str:
    """Return ``data.c``.

    Parameters
    ----------
    library
        The model.
    name
        The scene's.
    run
        Its numbers.

    Raises
    ------
    SolverError
        If the scene has no equilibrium.
    LtcgearError
        If a number is not finite.
    """
    p = library.parameters(run.values)
    start = find_equilibrium(library, p, tables=run.tables).x
    structure = [*_functions(), *_labels(library.manifest), *_places(library, p), *_tables(library.manifest, run)]
    key = digest([library.manifest.key, name, *structure])
    numbers = [_array("double", "values", _reals(p)), _array("double", "start", _reals(start))]
    return "\n".join(
        [HEAD.format(name=name.replace("*/", "* /")), *structure, *numbers, _model(library, name, key, run), ""]
    )


def fixed_parameters(manifest: Manifest) -> list[bool]:
    """Return which parameters follow from structure or switch the model, and so cannot be set."""
    tied = set(chain.from_iterable((c.start, c.teeth, c.ratio, c.frame, *c.periods) for c in manifest.clocks))
    return [manifest.roles[name] not in CONTINUOUS or name in tied for name, _ in manifest.parameters]


def _bounds(manifest: Manifest) -> Iterable[Iterable[str]]:
    """Return the least and the most values of all parameters."""
    return zip(*(map(_real, BOUNDS[manifest.bounds[name]]) for name, _ in manifest.parameters), strict=True)


def _functions() -> list[str]:
    """Declare the functions of model.c."""
    lines = []
    for name in CODES.values():
        lines.append(f"int {name}(const double **arg, double **res, ltcgear_whole *iw, double *w, int mem);")
        lines.append(f"int {name}_work(ltcgear_whole *arg, ltcgear_whole *res, ltcgear_whole *iw, ltcgear_whole *w);")
    return lines


def _labels(manifest: Manifest) -> list[str]:
    """Write the names and units of states, parameters and outputs."""
    named = {
        "states": [(state.name, state.unit) for state in manifest.states],
        "parameters": list(manifest.parameters),
        "outputs": [(f"{report.quantity}:{report.item}", report.unit) for report in manifest.reports],
    }
    return [
        _array("ltcgear_label", f"{key}_labels", (f"{{{_text(name)}, {_text(unit)}}}" for name, unit in pairs), "\n  ")
        for key, pairs in named.items()
    ]


def _places(library: Library, p: Vector) -> list[str]:
    """Write what belongs to what: freedoms, clocks, holds, mesh forces, the Jacobian's non-zeros."""
    manifest = library.manifest
    names = [name for name, _ in manifest.parameters]
    contacts = {connection.hold for connection in manifest.connections}  # others choose the sign of a friction force
    sparsity = library.functions["jac_rhs"].sparsity_out(0)
    forces = (i for i, report in enumerate(manifest.reports) if report.quantity == "mesh_force")
    freedoms = (
        f"{{{i}, {j}, {names.index(manifest.states[i].inertia)}, {int(manifest.states[i].turns)}}}"
        for i, j in zip(library.index(""), library.index(".rate"), strict=True)
    )
    return [
        _array("unsigned char", "fixed", map(int, fixed_parameters(manifest))),
        *(_array("double", name, values) for name, values in zip(("least", "most"), _bounds(manifest), strict=True)),
        _array("ltcgear_freedom", "freedoms", freedoms),
        _array("ltcgear_clock", "clocks", _clocks(manifest, p), "\n  "),
        _array("ltcgear_whole", "holds", map(names.index, manifest.holds)),
        _array("unsigned char", "hold_closes", (int(hold in contacts) for hold in manifest.holds)),
        _array("ltcgear_whole", "forces", forces),
        _array("ltcgear_whole", "jacobian_colind", sparsity.colind()),
        _array("ltcgear_whole", "jacobian_row", sparsity.row()),
    ]


def _clocks(manifest: Manifest, p: Vector) -> Iterable[str]:
    """Write the clocks; of several that a mesh has, which go alike, the first counts for its level and its phases."""
    told = [(report.quantity, report.item) for report in manifest.reports]
    counted = {""}
    for course in read_courses(manifest, p):
        mesh = "" if course.mesh in counted else course.mesh
        counted.add(mesh)
        phases = [_place(told, (quantity, mesh)) for quantity in PHASES]
        yield _clock(course, [_place(manifest.levels, mesh), *phases])


def _clock(course: ClockNumbers, counted: Sequence[int]) -> str:
    """Write one clock, see ``ltcgear_clock``."""
    # Whole numbers that C can count with; nothing is lost, unless a ratio is none of tooth numbers.
    advance = course.advance.limit_denominator(max(LARGEST // course.period, 1))
    modulus = advance.denominator * course.period
    periods, step = divmod(advance.numerator, modulus)
    wholes = (
        course.index, *counted, step, advance.denominator, modulus, periods * course.period, course.period,
    )  # fmt: skip
    return f"{{{', '.join(map(str, wholes))}, {_real(course.unit)}}}"


def _tables(manifest: Manifest, run: PlainRun) -> list[str]:
    """Write the loads over time."""
    used = list(dict.fromkeys(signal.table for signal in manifest.signals))
    lines, tables = [], []
    for i, name in enumerate(used):
        time, value = insert_zeros(np.array(run.tables[name], dtype=np.float64))
        lines += [_array("double", f"time_{i}", _reals(time)), _array("double", f"value_{i}", _reals(value))]
        tables.append(f"{{{_text(name)}, {len(time)}, time_{i}, value_{i}}}")
    return [
        *lines,
        _array("ltcgear_table", "tables", tables, "\n  "),
        _array("ltcgear_whole", "signal_table", (used.index(signal.table) for signal in manifest.signals)),
        _array("unsigned char", "signal_slope", (int(signal.slope) for signal in manifest.signals)),
    ]


def _model(library: Library, name: str, key: str, run: PlainRun) -> str:
    """Write the structure that holds all of it."""
    manifest = library.manifest
    parameters, states = [name for name, _ in manifest.parameters], [state.name for state in manifest.states]
    sizes = {
        "states": states, "levels": manifest.levels, "signals": manifest.signals, "holds": manifest.holds,
        "parameters": parameters, "outputs": manifest.reports, "tables": {signal.table for signal in manifest.signals},
        "freedoms": library.index(""),
        "clocks": manifest.clocks, "forces": [r for r in manifest.reports if r.quantity == "mesh_force"],
    }  # fmt: skip
    places = {
        "angle": _place(states, "reference.angle"),
        "free_speed": _place(states, "reference.speed"),
        "speed": _place(parameters, "reference.speed"),
        "speed_signal": _place([signal.name for signal in manifest.signals], "reference.speed"),
        "speed_held": int(manifest.reference == "speed" and "reference.speed" in parameters),
        "pull": _place(parameters, PULL),
        "varying": _place(parameters, VARYING),
        "closing": _place(parameters, CLOSING),
    }
    fields = {
        "name": _text(name), "key": _text(key), "t_end": _real(run.t_end), "rate": _real(run.rate),
        **{f"n_{kind}": len(items) for kind, items in sizes.items()},
        **{kind: f"{kind}_labels" for kind in ("states", "parameters", "outputs")},
        **{field: field for field in SAME}, "parameter_values": "values", "parameter_fixed": "fixed",
        "parameter_least": "least", "parameter_most": "most",
        **{field: f"{{{function}, {function}_work}}" for field, function in CODES.items()}, **places,
    }  # fmt: skip
    lines = "".join(f"  .{field} = {value},\n" for field, value in fields.items())
    return f"const ltcgear_model ltcgear_scene = {{\n{lines}}};"


def _place(names: Sequence[object], name: object) -> int:
    """Return the index of a name, -1 if it is missing."""
    return list(names).index(name) if name in names else -1


def _array(kind: str, name: str, items: Iterable[object], between: str = " ") -> str:
    """Write a constant array; C knows none without an item, so an empty one has one that nobody reads."""
    texts = [str(item) for item in items] or ["{0}" if kind.startswith("ltcgear_") and kind != "ltcgear_whole" else "0"]
    if between != " ":
        return f"static const {kind} {name}[] = {{{between}{f',{between}'.join(texts)}\n}};"
    lines, line = [], ""
    for text in texts:
        if len(line) + len(text) > 115:
            lines.append(line)
            line = ""
        line += f" {text},"
    return f"static const {kind} {name}[] = {{\n " + "\n ".join([*lines, line]) + "\n};"


def _real(value: float) -> str:
    """Write a number, to the last bit."""
    if not np.isfinite(value):
        raise LtcgearError(f"a number of the scene is {value}; plain C takes finite ones")
    return repr(float(value))


def _reals(values: Iterable[float]) -> list[str]:
    """Write numbers."""
    return [_real(value) for value in values]


def _text(value: str) -> str:
    """Write a string; C would read ``??/`` as a backslash (a trigraph)."""
    return json.dumps(value).replace("?", "\\?")
