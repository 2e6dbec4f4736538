"""Ranges: every quantity of a scene is refused by its key where it is no number, negative, or no size of a gearbox."""

import re
from pathlib import Path
from typing import get_args

import pytest
from ltcgear.generated.errors import SceneError
from ltcgear.symbolic.scene.load import make_scene, read_source
from ltcgear.symbolic.schema.quantities import Quantity
from ltcgear.symbolic.schema.ranges import MODULE, RANGES
from ltcgear.symbolic.schema.scene_schema import Pair, Planetary, Scene
from ltcgear.symbolic.schema.series import Series
from pydantic import BaseModel

DOCS = Path(__file__).parents[3] / "docs" / "scenes.md"


def quantities(model, path):
    """Yield dotted key and mark of every field of a schema's tables that is a quantity, a place in a list as 0."""
    for key, field in model.model_fields.items():
        here = f"{path}.{key}".lstrip(".")
        for mark in field.metadata:
            if isinstance(mark, Quantity | Series):
                yield here, mark
        yield from nested(field.annotation, here)


def nested(annotation, here):
    """Yield the quantities inside a type."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        place = {Planetary: "stages.gear", Pair: "stages.pair"}.get(annotation, here)
        yield from quantities(annotation, place)
    for mark in getattr(annotation, "__metadata__", ()):
        if isinstance(mark, Quantity | Series):
            yield here, mark
    origin = getattr(annotation, "__origin__", None)
    inside = {list: f"{here}.0", dict: f"{here}.x"}.get(origin, here)
    for part in get_args(annotation):
        yield from nested(part, inside)


ALL = dict(sorted(quantities(Scene, "")))
SINGLE = {key: mark for key, mark in ALL.items() if isinstance(mark, Quantity)}
TABLES = {key: mark for key, mark in ALL.items() if isinstance(mark, Series)}


def told_of(key, value):
    """Return what a scene is refused for that holds nothing else at a key."""
    *path, last = key.split(".")
    tree = {"title": "x"}
    for number, part in enumerate([*path, last]):
        after = [*path, last, ""][number + 1]
        if number == len(path):
            inner = value
        else:
            inner = [] if after == "0" else {"kind": {"gear": "planetary", "pair": "pair"}.get(part, ...)}
            inner = {} if inner == {"kind": ...} else inner
        at = tree
        for step in [*path, last][:number]:
            at = at[0] if step == "0" else at[step]
        if part == "0":
            at.append(inner)
        else:
            at[part] = inner
    try:
        make_scene(tree)
    except SceneError as error:
        lines = [line.strip() for line in str(error).splitlines()[1:]]
    else:
        lines = []
    return [line for line in lines if line.startswith(f"{key}:")]


def test_the_schema_is_walked_through():
    assert len(SINGLE) > 90
    assert len(TABLES) >= 6
    assert {"stages.gear.pin.friction_load", "loads.x.slip.breakdown_torque", "gravity.0"} <= set(SINGLE)
    assert {"stages.gear.planet_angles.0", "stages.pair.mesh.tooth_errors.0.error", "rotors.x.inertia"} <= set(SINGLE)


@pytest.mark.parametrize("key", SINGLE)
def test_what_is_no_number_of_a_gearbox_is_refused_by_key(key):
    mark = SINGLE[key]
    unit, (least, most) = mark.unit, mark.bounds or RANGES[mark.unit]
    bad = [f"{number} {unit}" for number in ("nan", "inf", "-inf", 2 * most, -2 * most, 1e300)]
    bad += [float("nan"), float("inf"), -1, 0, True, [f"1 {unit}"], {}, ""]
    if mark.positive:
        bad += [f"0 {unit}", f"-{most!r} {unit}", f"{least / 2!r} {unit}"]
    for value in bad:
        (line,) = told_of(key, value)
        assert re.search(r"; (write it like|check number and unit)|must be greater than zero", line), line
    for good in [least, most] if mark.positive else [most, -most, least]:
        assert not [line for line in told_of(key, f"{good!r} {unit}") if "size" in line or "greater than zero" in line]


@pytest.mark.parametrize("key", TABLES)
@pytest.mark.parametrize("bad", ["nan", "inf", "1e99", "-1e99"])
def test_what_is_no_number_of_a_gearbox_is_refused_in_tables(key, bad):
    mark = TABLES[key]
    (line,) = told_of(key, [[f"0 {mark.first}", f"0 {mark.second}"], [f"1 {mark.first}", f"{bad} {mark.second}"]])
    assert line.startswith(f"{key}: row 2: ")


def test_the_page_lists_the_ranges():
    text = DOCS.read_text(encoding="utf-8")
    for unit, (least, most) in {**RANGES, "m (`module`)": MODULE}.items():
        assert f"| {unit} | {least:g} | {most:g} |" in text, unit


def test_the_sizes_that_were_seen_to_pass_are_refused():
    sizes = {
        "stages.lsp.planet.disc.width": "1.2e9 mm", "stages.lsp.sun.disc.width": "1e-9 mm",
        "stages.lsp.pin.stiffness": "1e20 N/m", "loads.ring.speed": "4e14 rpm",
    }  # fmt: skip
    tree = read_source("lsp").tables()
    for key, value in sizes.items():
        *path, last = key.split(".")
        at = tree
        for part in path:
            at = at[part]
        at[last] = value
    with pytest.raises(SceneError) as caught:
        make_scene(tree)
    for key, value in sizes.items():
        assert f"{key}: '{value}' is no size of a gearbox (" in str(caught.value)
