"""The page docs/effects.md, written from the table of effects."""

from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

from ..schema.effects import EFFECTS, Effect

HEAD = """# Effects

A scene names the effects it wants under `[effects]`; the generated C holds nothing else: no symbol, no state and no
operation of an effect that is left out. Keys that effects need are described in [scenes](scenes.md), laws in
[method](method.md). `ltcgear effects` prints this table, `ltcgear info SCENE` tells what each effect does in a scene,
and `ltcgear cost SCENE` what it costs and buys there.

This page is written by `make docs` from `symbolic/schema/effects.py`.

| effect | values (default first) | left out by |
|---|---|---|
"""


def list_effects() -> list[dict[str, Any]]:
    """Return the table of effects as plain values, ready for JSON."""
    return [asdict(effect) for effect in EFFECTS]


def write_effects() -> str:
    """Return the page as Markdown."""
    rows = [f"| [{e.name}](#{e.name}) | {_values(e)} | `{e.without}` |\n" for e in EFFECTS]
    return HEAD + "".join(rows) + "".join(_section(effect) for effect in EFFECTS)


def _values(effect: Effect) -> str:
    """Write the values, the default first."""
    others = [value for value in effect.values if value != effect.default]
    return ", ".join(f"`{value}`" for value in (effect.default, *others))


def _section(effect: Effect) -> str:
    """Write the section on one effect."""
    lines = [effect.help, f"- Values: {_values(effect)}.", *_conditions(effect), f"- Source: {effect.source}."]
    return f"\n## {effect.name}\n\n{lines[0]}\n\n" + "\n".join(lines[1:]) + "\n"


def _conditions(effect: Effect) -> Iterator[str]:
    """Write what the values need and exclude."""
    for value, need in effect.needs.items():
        yield f"- `{value}` needs {need}."
    for value, exclusions in effect.excludes.items():
        for item in exclusions:
            others = " or ".join(f"`{item.effect} = {other}`" for other in item.values)
            yield f"- `{value}` cannot stand beside {others}: {item.reason}."
