"""Advice works: whoever does what a message about a scene says has a scene that is accepted."""

import re
from copy import deepcopy

import pytest
from ltcgear.generated.errors import SceneError
from ltcgear.symbolic.scene.load import load_scene, make_scene, read_source
from ltcgear.symbolic.schema.effects import DEFAULTS, EFFECTS, contradictions

from ..advised import ADVISED


def edited(tree, changes):
    """Put values at dotted keys, ``...`` taking one away."""
    tree = deepcopy(tree)
    for key, value in changes.items():
        *path, last = key.split(".")
        at = tree
        for part in path:
            at = at.setdefault(part, {})
        if value is ...:
            at.pop(last, None)
        else:
            at[last] = deepcopy(value)
    return tree


@pytest.mark.parametrize("name", ADVISED)
def test_the_cure_that_a_message_names_works(name):
    scene, defect, told, cures = ADVISED[name]
    spoilt = edited(read_source(scene).tables(), defect)
    with pytest.raises(SceneError) as caught:
        make_scene(spoilt)
    assert told in str(caught.value)
    for cure in cures:
        make_scene(edited(spoilt, cure))


CONFLICTS = [
    (effect.name, value, exclusion.effect, other)
    for effect in EFFECTS
    for value, exclusions in effect.excludes.items()
    for exclusion in exclusions
    for other in exclusion.values
]


@pytest.mark.parametrize("conflict", CONFLICTS, ids=" ".join)
def test_effects_that_contradict_each_other_are_told_with_both_ways_out(conflict):
    one, value, two, other = conflict
    with pytest.raises(SceneError) as caught:
        load_scene("lsp", {f"effects.{one}": value, f"effects.{two}": other})
    (line,) = [line for line in str(caught.value).splitlines() if f"{two} = {other!r}" in line]
    ways = re.findall(r'(\w+) = ((?:"[^"]+"(?: or )?)+)', line.split(";")[-1])
    assert {effect for effect, _ in ways} == {one, two}
    for effect, values in ways:
        for way in re.findall(r'"([^"]+)"', values):  # the value that is left may contradict a third
            kept = DEFAULTS | {one: value, two: other, effect: way}
            assert f".{line.strip().removeprefix('effects.')}" not in list(contradictions(kept))


PUT = {
    "gravity.0": ("'1 m/s^2'", """gravity='[...]'""", {"gravity": "['1 m/s^2', '0 m/s^2']"}),
    "stages.lsp.position_errors.0": (
        "1",
        "stages.lsp.position_errors='[...]'",
        {"stages.lsp.position_errors": "[{planet = 1}]"},
    ),
}


@pytest.mark.parametrize("key", PUT)
def test_a_list_that_is_not_there_is_set_as_a_whole(key):
    value, told, cure = PUT[key]
    with pytest.raises(SceneError) as caught:
        load_scene("lsp", {key: value})
    assert f"set the whole list first, {told}" in str(caught.value)
    load_scene("lsp", cure)
