"""The table of effects: what is left out leaves nothing, idle effects warn, contradictory ones are refused."""

import json

import pytest
from ltcgear.generated.errors import SceneError
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.checks.all_checks import check_model
from ltcgear.symbolic.describe.advice import warnings
from ltcgear.symbolic.emit.pipeline import generate
from ltcgear.symbolic.scene.load import make_scene
from ltcgear.symbolic.schema import effects
from ltcgear.symbolic.schema.effects import DEFAULTS, EFFECTS, Exclusion

from ...runtime.everything import (
    BARE,
    DATA,
    NO_ZERO,
    ZERO,
    acting,
    all_pairs,
    allowed,
    beside,
    covering,
    everything,
    labelled,
    values_on,
    without,
)

ON = [pytest.param(effect, value, id=f"{effect}={value}") for effect, value in values_on()]
VARIANTS = [pytest.param(variant, id=labelled(variant)) for variant in covering()]
NEEDS = [pytest.param(e, value, id=f"{e.name}={value}") for e in EFFECTS for value in e.needs]
EXCLUSIONS = [
    pytest.param(e.name, value, item.effect, other, id=f"{e.name}={value}, {item.effect}={other}")
    for e in EFFECTS
    for value, items in e.excludes.items()
    for item in items
    for other in item.values
]


# --- the table


@pytest.mark.parametrize("effect", EFFECTS, ids=lambda effect: effect.name)
def test_an_entry_of_the_table_is_consistent(effect):
    assert len(set(effect.values)) == len(effect.values) > 1
    assert {effect.default, effect.without, *effect.needs, *effect.excludes} <= set(effect.values)
    assert effect.help.endswith(".")
    assert effect.source
    for items in effect.excludes.values():
        for item in items:
            assert item.effect != effect.name
            assert set(item.values) <= set(effects.BY_NAME[item.effect].values)
            assert item.reason


def test_defaults_and_what_leaves_out_can_stand_together():
    assert allowed(*DEFAULTS.items())
    assert allowed(*((effect.name, effect.without) for effect in EFFECTS))


def test_every_effect_has_a_zero_or_a_reason():
    assert set(ZERO) | set(NO_ZERO) == set(values_on())
    assert not set(ZERO) & set(NO_ZERO)


# --- what is left out leaves nothing


def shape(scene):
    """What a scene leaves in its model: structure and numbers."""
    model = build_model(scene)
    return json.loads(model.structure()), model.values()


@pytest.mark.parametrize(("effect", "value"), ON)
def test_an_effect_leaves_a_trace_where_it_is_on(effect, value):
    chosen = acting(effect, value)
    on, off = shape(everything(chosen)), shape(everything(chosen | {effect: without(effect)}))
    assert on != off


@pytest.mark.parametrize("effect", DATA)
def test_what_is_left_out_is_as_if_its_data_were_not_there(effect):
    on = next(value for value in effects.BY_NAME[effect].values if value != without(effect))
    chosen = acting(effect, on) | {effect: without(effect)}
    with_data, bare = (everything(chosen, *settings) for settings in ((), DATA[effect]))
    assert with_data != bare
    assert shape(with_data) == shape(bare)
    one, two = (generate(build_model(scene)) for scene in (with_data, bare))
    assert one.c == two.c
    assert one.manifest == two.manifest


def test_data_are_those_of_effects():
    assert set(DATA) <= set(DEFAULTS)


def names(artifact):
    """All names that a manifest holds."""
    manifest = artifact.manifest
    reports = {f"{report.quantity} {report.item}" for report in manifest.reports}
    return {name for name, _ in manifest.parameters} | reports | {state.name for state in manifest.states}


@pytest.mark.parametrize(("effect", "value"), ON)
def test_the_c_of_what_is_left_out_is_smaller(effect, value):
    chosen = acting(effect, value)
    on, off = (generate(build_model(everything(e))) for e in (chosen, chosen | {effect: without(effect)}))
    brought = names(on) - names(off)
    assert not any(name in off.c for name in brought)
    assert on.c != off.c
    if names(off) <= names(on):  # where the effect only adds; its Jacobian may be the sparser one all the same
        assert off.manifest.functions["rhs"].operations <= on.manifest.functions["rhs"].operations


# --- all pairs


def test_the_variants_hold_every_pair_that_is_allowed():
    held = {frozenset(((a, x), (b, y))) for v in covering() for a, x in v.items() for b, y in v.items() if a != b}
    assert held == all_pairs()
    assert all(set(variant) == set(DEFAULTS) and allowed(*variant.items()) for variant in covering())
    assert len(covering()) <= 60


@pytest.mark.parametrize("variant", VARIANTS)
def test_equations_of_all_pairs_pass_their_checks(variant):
    failed = [
        f"{c.name}: {c.value:.3g}; {c.note}" for c in check_model(build_model(everything(variant))) if not c.passed
    ]
    assert failed == []


# --- what cannot be together, or cannot act


def refusal(effect, value, other, excluded):
    """The message for two values that exclude each other."""
    with pytest.raises(SceneError) as caught:
        everything({effect: value, other: excluded})
    return str(caught.value)


@pytest.mark.parametrize(("effect", "value", "other", "excluded"), EXCLUSIONS)
def test_contradictory_values_are_refused_by_name(effect, value, other, excluded):
    text = refusal(effect, value, other, excluded)
    assert all(word in text for word in (f"effects.{effect}", repr(value), f"{other} = {excluded!r}"))


def test_an_exclusion_of_the_table_is_heeded(monkeypatch):
    exclusion = Exclusion("contact", ("backlash",), "the one carries the other")
    monkeypatch.setitem(effects.BY_NAME["gravity"].__dict__, "excludes", {"on": (exclusion,)})
    text = refusal("gravity", "on", "contact", "backlash")
    assert "effects.gravity: 'on' and contact = 'backlash' contradict each other: the one carries the other" in text
    assert frozenset((("gravity", "on"), ("contact", "backlash"))) not in all_pairs()
    covering.cache_clear()
    try:
        assert not any(v["gravity"] == "on" and v["contact"] == "backlash" for v in covering())
    finally:
        covering.cache_clear()


@pytest.mark.parametrize(("effect", "value"), NEEDS)
def test_an_idle_effect_warns_with_what_it_needs(effect, value):
    told = warnings(make_scene(BARE | {"effects": beside(effect.name, value, DEFAULTS)}))
    if value == effect.default:  # nobody asked for it, and there are no teeth
        assert told == []
        return
    assert any(f"effects.{effect.name} = {value!r}" in line and effect.needs[value] in line for line in told), told


def test_the_scene_with_all_data_has_no_idle_effect():
    for effect, value in values_on():
        told = warnings(everything(acting(effect, value)))
        assert not any(f"effects.{effect} " in line for line in told)
