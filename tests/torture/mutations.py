"""Mutations of scenes: keys, types, numbers, units, texts, tables and bytes, one after the other."""

import datetime
import json
import re
import sys
from copy import deepcopy
from typing import Any

import numpy as np
from ltcgear.symbolic.schema.effects import EFFECTS

QUANTITY = re.compile(r"([-+]?[0-9.]+(?:[eE][-+]?\d+)?) (.*)", re.DOTALL)
NUMBERS = (0, -1, 1e300, -1e300, 1e-300, 5e-324, float("nan"), float("inf"), 10**30, -(2**63), 10**400, 0.1, 1e7, 2**31)
UNITS = ("Hz", "kN*m", "rpm", "deg", "parsec", "m^2", "1/s", "N/m", "", "degC", "%", "kg*m^2*s^-3", "um", "m" * 500)
TEXTS = (
    "", " ", "\x1b[31mred\x1b[0m", "\x00", "a\nb", "ä" * 300, "\u202emirror", "\U0001f600", "x" * 100_000, "../../etc",
    "nan", "1e999 N/m", "__import__('os').getcwd()", "9**9**9**9", "1e3 m" * 50, "{}", "%s%n", "\ufeff",
    "'; --", "1 m)))",
    "\u0661 m", "1_000 mm", "0x10 m", "-0 kg", "1 m/0", "1 m + 1 m", "(" * 3000, "$x$", "<b>",
    "\\frac{", "$\\undefined{$",
)  # fmt: skip
OTHERS = (
    True,
    False,
    [],
    {},
    [[]],
    [1, "a", []],
    {"a": {}},
    datetime.date(2020, 1, 1),
    datetime.datetime(1, 1, 1),
    [None],
)
Path = tuple[Any, ...]


def write_toml(raw: Any) -> str:
    """Return tables as TOML, each on one line."""
    before = sys.getrecursionlimit()
    sys.setrecursionlimit(20_000)  # deep ones
    try:
        return "".join(f"{_text(key)} = {_value(value)}\n" for key, value in raw.items())
    finally:
        sys.setrecursionlimit(before)


def _value(value: Any) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, dict):
        return "{" + ", ".join(f"{_text(k)} = {_value(v)}" for k, v in value.items()) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(_value, value)) + "]"
    return _text(value) if isinstance(value, str) else "''" if value is None else str(value)


def _text(value: object) -> str:
    return json.dumps(str(value), ensure_ascii=False)


DEEPEST = 40
"""Levels of a scene that are looked at; one mutation nests by hundreds."""


def places(raw: Any, at: Path = ()) -> list[Path]:
    """Return where anything stands in tables and lists."""
    pairs = raw.items() if isinstance(raw, dict) else enumerate(raw) if isinstance(raw, list) else ()
    if len(at) > DEEPEST:
        return []
    return [place for key, value in pairs for place in ((*at, key), *places(value, (*at, key)))]


def look(raw: Any, place: Path) -> Any:
    """Return what stands at a place."""
    for key in place:
        raw = raw[key]
    return raw


class Mutator:
    """Changes tables at random."""

    def __init__(self, generator: np.random.Generator) -> None:
        self.generator = generator

    def one(self, items: Any) -> Any:
        return items[int(self.generator.integers(len(items)))]

    def place(self, raw: Any, wanted: Any = lambda value: True) -> Path | None:
        """A place that holds what is wanted."""
        found = [place for place in places(raw) if wanted(look(raw, place))]
        return self.one(found) if found else None

    def mutate(self, raw: Any) -> list[str]:
        """Change tables in place; return the names of what was done."""
        mild = self.generator.random() < 0.6
        kinds = MILD if mild else WILD
        chosen = [self.one(kinds) for _ in range(int(self.generator.choice([1, 1, 1, 2, 3, 6])))]
        for kind in chosen:
            if raw:
                kind(self, raw)
        return [kind.__name__.strip("_") for kind in chosen]

    def put(self, raw: Any, place: Path | None, value: Any) -> None:
        if place is not None:
            look(raw, place[:-1])[place[-1]] = value

    # --- mild: often still a scene

    def _scale(self, raw: Any) -> None:
        place = self.place(raw, lambda value: isinstance(value, str) and QUANTITY.fullmatch(value))
        if place:
            number, unit = QUANTITY.fullmatch(look(raw, place)).groups()
            power = self.one([0.3, 1, 3, 9])
            self.put(raw, place, f"{float(number) * 10 ** self.generator.uniform(-power, power):.12g} {unit}")

    def _negate(self, raw: Any) -> None:
        place = self.place(raw, lambda value: isinstance(value, str) and QUANTITY.fullmatch(value))
        if place:
            number, unit = QUANTITY.fullmatch(look(raw, place)).groups()
            self.put(raw, place, f"{-float(number)!r} {unit}")

    def _nudge(self, raw: Any) -> None:
        place = self.place(raw, lambda value: isinstance(value, (int, float)) and not isinstance(value, bool))
        if place:
            value = look(raw, place)
            moved = (
                value + self.one([-2, -1, 1, 2, 40])
                if isinstance(value, int)
                else value * self.generator.uniform(-1, 3)
            )
            self.put(raw, place, moved)

    def _effect(self, raw: Any) -> None:
        effect, table = self.one(EFFECTS), raw.setdefault("effects", {})
        if isinstance(table, dict):
            table[effect.name] = self.one([*effect.values, "on", "of"])

    def _drop(self, raw: Any) -> None:
        place = self.place(raw)
        if place:
            del look(raw, place[:-1])[place[-1]]

    # --- wild: hardly ever a scene

    def _rename(self, raw: Any) -> None:
        place = self.place(raw)
        holder = look(raw, place[:-1]) if place else None
        if isinstance(holder, dict):
            key = str(place[-1])
            holder[self.one([key[:-1], key + "x", key.upper(), f"{key}.{key}", *TEXTS])] = holder.pop(place[-1])

    def _copy(self, raw: Any) -> None:
        place = self.place(raw)
        holder = look(raw, place[:-1]) if place else None
        if isinstance(holder, dict):
            holder[f"{place[-1]}_2"] = deepcopy(holder[place[-1]])
        elif isinstance(holder, list):
            holder.append(deepcopy(holder[0]))

    def _swap(self, raw: Any) -> None:
        one, two = self.place(raw), self.place(raw)
        if one and two and one[: len(two)] != two and two[: len(one)] != one:
            here, there = deepcopy(look(raw, one)), deepcopy(look(raw, two))
            self.put(raw, one, there)
            self.put(raw, two, here)

    def _type(self, raw: Any) -> None:
        self.put(raw, self.place(raw), deepcopy(self.one(OTHERS)))

    def _number(self, raw: Any) -> None:
        place, number = self.place(raw), self.one(NUMBERS)
        if place:
            found = QUANTITY.fullmatch(str(look(raw, place)))
            self.put(raw, place, f"{number} {found[2]}" if found and self.generator.random() < 0.8 else number)

    def _unit(self, raw: Any) -> None:
        place = self.place(raw, lambda value: isinstance(value, str) and QUANTITY.fullmatch(value))
        if place:
            self.put(raw, place, f"{QUANTITY.fullmatch(look(raw, place))[1]} {self.one(UNITS)}")

    def _text(self, raw: Any) -> None:
        self.put(raw, self.place(raw), self.one(TEXTS))

    def _deep(self, raw: Any) -> None:
        nested: Any = self.one(["1 m", 1, {}])
        table = self.generator.random() < 0.5
        for _ in range(self.one([10, 90, 400])):
            nested = {"a": nested} if table else [nested]
        self.put(raw, self.place(raw), nested)

    def _huge(self, raw: Any) -> None:
        rows = self.one([1000, 20_000])
        self.put(raw, self.place(raw), self.one([
            [[f"{i} s", "1 rpm"] for i in range(rows)], {f"k{i}": {} for i in range(rows)}, [1.0] * rows,
        ]))  # fmt: skip


MILD = [Mutator._scale] * 6 + [
    Mutator._negate,
    Mutator._nudge,
    Mutator._nudge,
    Mutator._effect,
    Mutator._effect,
    Mutator._drop,
]
WILD = [
    Mutator._drop, Mutator._rename, Mutator._copy, Mutator._swap, Mutator._type, Mutator._number, Mutator._unit,
    Mutator._text, Mutator._deep, Mutator._huge, Mutator._scale, Mutator._effect,
]  # fmt: skip


def damage(data: bytes, generator: np.random.Generator) -> bytes:
    """Change bytes: flips, holes, cuts, insertions, blocks in another order."""
    changed, size = bytearray(data), max(len(data), 2)
    kind = int(generator.integers(7))
    start, length = int(generator.integers(size)), int(2 ** generator.uniform(0, np.log2(size)))
    if kind <= 1:
        for _ in range(int(2 ** generator.integers(0, 8)) if kind else 1):
            changed[int(generator.integers(len(changed)))] ^= 1 << int(generator.integers(8))
    elif kind == 2:
        changed[start : start + length] = bytes(len(changed[start : start + length]))
    elif kind == 3:
        del changed[start:]
    elif kind == 4:
        del changed[start : start + length]
    elif kind == 5:
        changed[start:start] = generator.bytes(min(length, 4096))
    else:
        other = int(generator.integers(size))
        one, two = changed[start : start + 512], changed[other : other + 512]
        changed[start : start + 512], changed[other : other + 512] = two, one
    return bytes(changed)
