"""Chapters on element instances, and on meshes and loads over time."""

import re
from collections.abc import Iterator

from ..elements.base import real
from ..mechanics.model import Instance, Model
from . import waves
from .chapter_laws import law_anchor, write_unit
from .content import Chapter, CrossReference, Maths, Part, Text
from .laws import write_law
from .notation import break_sum, typeset

Row = tuple[Part | Text, ...]
NUMBERED = re.compile(r"(.*)\.(\d+)((?:\.[a-z_0-9]+)?)")


def write_elements(chapter: Chapter, model: Model) -> None:
    """Write the chapter on instances: numbers, names, bodies and parameters of all elements."""
    chapter.say(
        "Every element has a number, by which the equations of motion name it. Equal elements of the planets of a "
        "stage are one row: i counts them."
    )
    rows = [_instance_row(numbers, group) for numbers, group in _grouped(model)]
    chapter.tabulate(("no.", "element", "law", "bodies 1, 2, 3", "parameters"), rows)
    chapter.head("Values of the parameters", "values")
    values = [(p.name, f"{p.value:.9g}", write_unit(p.unit)) for p in model.parameters]
    chapter.tabulate(("parameter", "value", "unit"), values)


def _grouped(model: Model) -> Iterator[tuple[range, list[Instance]]]:
    """Yield runs of elements that differ by the number of their planet only, with their own numbers."""
    found: dict[object, list[tuple[int, Instance]]] = {}
    for number, instance in enumerate(model.instances, start=1):
        key = (instance.element, _general(instance.name), tuple(map(_general, instance.bodies)), _bound(instance))
        found.setdefault(key, []).append((number, instance))
    for run in found.values():
        yield range(run[0][0], run[-1][0] + 1, _stride([n for n, _ in run])), [instance for _, instance in run]


def _stride(numbers: list[int]) -> int:
    """Return the increment of the numbers of a run."""
    return numbers[1] - numbers[0] if len(numbers) > 1 else 1


def _general(name: str) -> str:
    """Write i for the number of a planet, mesh or pin."""
    found = NUMBERED.fullmatch(name)
    return f"{found[1]}.i{found[3]}" if found else name


def _bound(instance: Instance) -> tuple[tuple[str, str], ...]:
    """Return the bindings of an element's parameters, with i for numbers of planets."""
    return tuple((key, _general(name)) for key, name in instance.bind.items())


def _instance_row(numbers: range, group: list[Instance]) -> Row:
    """Return the row of one or several equal elements."""
    first, several = group[0], len(group) > 1
    law = write_law(first.element)
    name = _general(first.name) if several else first.name
    told = ", ".join(map(str, numbers)) if len(numbers) <= 3 else f"{numbers[0]}, {numbers[1]}, ... {numbers[-1]}"
    bodies = ", ".join(_general(body) if several else body for body in first.bodies)
    parameters: list[Part] = []
    for symbol in law.element.parameters:
        bound = _general(first.bind[symbol.name]) if several else first.bind[symbol.name]
        parameters += [", "] * bool(parameters) + [Maths(typeset(symbol, law.letters)), f" = {_told(bound)}"]
    label = f"{name}, i = 1 to {len(group)}" if several else name
    return told, label, CrossReference(law.title, law_anchor(law)), bodies, tuple(parameters)


def _told(bound: str) -> str:
    """Say what a parameter is bound to."""
    return {
        "@level": "level of the mesh", "@turn": "0 in the frame", "@basis": "angle of the frame",
        "@phase": "phase of the mesh", "@stiffness": "stiffness at the phase", "@slope": "its slope",
        "@error": "error at the phase", "@error_rate": "its rate",
    }.get(bound, bound)  # fmt: skip


# --- over time


def write_meshes(chapter: Chapter, model: Model) -> None:
    """Write the chapter on phases, stiffness, errors, switching and loads."""
    if model.levels or any(phase.followed for phase in model.phases):
        _phases(chapter, model)
    else:
        chapter.say("No mesh follows its phase: stiffness is one number a mesh.")
    for kind in dict.fromkeys(item.kind for item in model.profiles):
        _wave(chapter, model, kind)
    if model.signals:
        chapter.head("Loads over time", "signals")
        chapter.say(
            "These follow tables, linear between two rows and constant beyond their ends; every row ends a segment of "
            "the integration."
        )
        rows = [(s.name, write_unit(s.unit), s.table, str(len(model.tables[s.table]))) for s in model.signals]
        chapter.tabulate(("signal", "unit", "table", "rows"), rows)


def _phases(chapter: Chapter, model: Model) -> None:
    """Write phases and levels."""
    nu, tau, start, phi, share = map(real, ("nu", "tau", "tau_0", "phi", "varsigma"))
    chapter.head("Phase of a mesh", "phases")
    chapter.say(
        "The phase counts the teeth of gear 1 that have passed the line of centres in the rigid motion (eqs 10 and 11)."
    )
    chapter.equate(break_sum(typeset(tau), nu * phi + start))
    if model.levels:
        chapter.equate(
            (rf"{typeset(real('level'))} = \begin{{cases}} 0, & \operatorname{{frac}}{typeset(tau)} < {typeset(share)}"
             r" \\ 1, & \text{else} \end{cases}",),
            "one pair of teeth in contact, or two (eq 9); every jump is an instant of its own in a simulation",
        )  # fmt: skip
    values, rows = model.values(), []
    shares = {level.name: level.share for level in model.levels}
    for item in (phase for phase in model.phases if phase.followed or phase.name in shares):
        rate = "0" if item.rate is None else f"{values[item.rate]:.9g}"
        part = f"{values[shares[item.name]]:.6g}" if item.name in shares else ""
        rows.append((item.name, rate, f"{values[item.start]:.9g}", part))
    chapter.tabulate(("mesh", "pitches a radian", "phase at the start", "part of single contact"), rows)


def _wave(chapter: Chapter, model: Model, kind: str) -> None:
    """Write one kind of profile over the phase."""
    wave = waves.WAVES[kind]
    chapter.head(wave.title[0].upper() + wave.title[1:], f"wave-{kind}")
    used = [item for item in model.profiles if item.kind == kind]
    names = ", ".join(dict.fromkeys(f"{item.quantity} of {_general(item.mesh)}" for item in used))
    left = typeset(real("k")) if used[0].quantity == "stiffness" else typeset(real("e"))
    chapter.equate(break_sum(left, wave.formula), f"for {names}")
    if wave.formula.has(waves.Wrap):
        chapter.say(Maths(r"\operatorname{wrap}\left(z\right)"), " is z less the nearest whole number.")
    if wave.formula.has(waves.Rise):
        z = real("z")
        rise = break_sum(typeset(waves.Rise(z)), waves.Rise.definition(z))
        chapter.equate(rise, "rises from 0 to 1, with six derivatives")
