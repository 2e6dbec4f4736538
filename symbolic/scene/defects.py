"""Messages about defects of a scene: key, reason and cure of each validation error."""

import re
from collections.abc import Iterable
from typing import Any, get_args

from pydantic import BaseModel

from ..schema import scene_schema
from ..schema.scene_schema import Scene

MOST_TOLD = 50
"""Largest number of reported defects per scene; the rest are counted."""
REASONS = {
    "missing": "is missing",
    "string_pattern_mismatch": "names are small letters, digits and _, beginning with a letter",
    "string_type": "must be text in quotes, {given}",
    "string_unicode": "must be text in UTF-8",
    "string_too_short": "must not be empty",
    "string_too_long": "must have {max_length} characters at most",
    "int_type": "must be a whole number without quotes, {given}",
    "int_from_float": "must be a whole number, {given}",
    "float_type": "must be a number without quotes and unit, {given}",
    "list_type": "must be a list in brackets, {given}",
    "dict_type": "must be a table, {given}",
    "model_type": "must be a table, {given}",
    "model_attributes_type": "must be a table, {given}",
    "too_short": "must have {min_length} items, not {actual_length}",
    "too_long": "must have {max_length} items at most, not {actual_length}",
}


def _fields_at(path: tuple[str | int, ...], kind: str) -> list[str]:
    """Return the valid keys of the table at ``path`` in a stage of that kind."""
    here: list[type[BaseModel]] = [Scene]
    for part in path:
        nested = [
            model
            for table in here
            for model in _models(table.model_fields[str(part)].annotation if part in table.model_fields else None)
        ]
        here = [model for model in nested if model.__name__.lower() == kind] or nested or here
    return sorted({key for table in here for key in table.model_fields} - {"name", "sources"})


def _models(annotation: object) -> list[type[BaseModel]]:
    """Return the table models inside a type annotation."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        return [annotation]
    return [model for part in get_args(annotation) for model in _models(part)]


def explain(item: Any) -> list[str]:  # noqa: ANN401
    """Turn one pydantic error into lines of: key, reason, cure."""
    location, kind = list(item["loc"]), ""
    if len(location) > 2 and location[0] == "stages" and location[2] != "[key]":
        kind = location.pop(2)  # pydantic puts it behind the stage's name
    location = [part for part in location if part != "[key]"]
    key = ".".join(str(part) for part in location)
    if len(location) > 1 and location[0] == "sources":
        key = f"{location[1]}.source"
    if item["type"] == "value_error":
        lines = str(item["ctx"]["error"]).split("\n")
        return [f"{key}{line}" if line.startswith(".") else f"{key}: {line}" for line in lines]
    if item["type"] == "extra_forbidden":
        known = _fields_at(tuple(location[:-1]), kind)
        return [f"{key}: unknown key; {scene_schema.suggest(location[-1], known, 'known keys')}"]
    if item["type"] in ("union_tag_not_found", "union_tag_invalid"):
        given = item["input"].get("kind") if isinstance(item["input"], dict) else None
        what = f"{given!r:.60} is no kind of stage" if given is not None else "is missing"
        return [f'{key}.kind: {what}; write kind = "planetary" or kind = "pair"']
    return [f"{key}: {_reason(item)}"]


def _reason(item: Any) -> str:  # noqa: ANN401
    """Say in the scene's own words what pydantic finds wrong with a value."""
    given, context = f"not {item['input']!r:.60}", item.get("ctx", {})
    if item["type"] in REASONS:
        return REASONS[item["type"]].format(given=given, **context)
    if item["type"] == "literal_error":
        allowed = re.findall(r"'([^']*)'", context["expected"])
        return f"must be {context['expected']}, {given}; {scene_schema.suggest(item['input'], allowed, 'values')}"
    return f"{item['msg'].replace('Input should be', 'must be')}, {given}"


def clean(text: str) -> str:
    """Return a text for the terminal: on one line, of bounded length, control characters written out."""
    shown = "".join(c if c.isprintable() else repr(c)[1:-1] for c in text)
    return shown if len(shown) <= 600 else f"{shown[:300]} ... {shown[-200:]}"


def list_faults(label: str, faults: Iterable[str]) -> str:
    """Put all faults into one message; beyond `MOST_TOLD` they are counted."""
    each = list(dict.fromkeys(faults))
    head = f"{label}: {len(each)} defect" + "s" * (len(each) > 1)
    more = [f"  and {len(each) - MOST_TOLD} defects more"] * (len(each) > MOST_TOLD)
    return "\n".join([head, *(f"  {clean(fault)}" for fault in each[:MOST_TOLD]), *more])
