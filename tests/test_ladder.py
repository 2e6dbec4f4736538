"""The ladder of benchmarks/ladder.py: its rungs are scenes, each with more than the one below; its page is of them."""

from importlib.util import module_from_spec, spec_from_file_location
from itertools import pairwise
from pathlib import Path

import pytest
from ltcgear.runtime.studies.force_comparison import MEASURES
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.describe.advice import warnings
from ltcgear.symbolic.emit.pipeline import obtain
from ltcgear.symbolic.scene.load import load_scene

PATH = Path(__file__).parents[1] / "benchmarks" / "ladder.py"


@pytest.fixture(scope="module")
def ladder():
    spec = spec_from_file_location("ladder", PATH)
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_every_rung_is_a_scene_of_its_own(ladder):
    assert len(ladder.RUNGS) == 8
    models = []
    for _, parts in ladder.RUNGS:
        scene = load_scene(ladder.SCENE, {key: value for part in parts for key, value in part.items()})
        models.append(build_model(scene))
        assert warnings(scene, models[-1]) == []
    assert all(one.structure() != two.structure() for one, two in pairwise(models))
    assert all(len(one.parameters) <= len(two.parameters) for one, two in pairwise(models))


def test_a_torsional_rig_needs_a_quarter_of_the_operations(ladder):
    """Of those of the shipped rig, which moves sideways; the page tells both, as the C counts them."""
    page, found = ladder.PAGE.read_text("utf-8"), {}
    for name, parts in ladder.RUNGS[:3]:
        scene = load_scene(ladder.SCENE, {key: value for part in parts for key, value in part.items()})
        manifest = obtain(build_model(scene)).manifest
        found[name] = manifest.functions["rhs"].operations
        assert f"| {name} | {len(manifest.states)} | {found[name]} |" in page
    torsional, _, lateral = found.values()
    assert 4 * torsional <= lateral


def test_the_page_holds_the_rungs(ladder):
    page = ladder.PAGE.read_text("utf-8")
    table = page[page.index(ladder.BEGIN) : page.index(ladder.END)]
    rows = [line.split(" | ")[0].removeprefix("| ") for line in table.splitlines() if line.startswith("| ")]
    assert rows == ["rung", *(name for name, _ in ladder.RUNGS)]


def test_a_rung_that_does_not_run_is_told(ladder):
    ran = {
        "effect": "low", "reason": "", "states": 4, "ops": {"rhs": 9, "jacobian": 20}, "ns_call": 31.4,
        "seconds_per_simulated_second": 0.51239, "counts": {"steps": 7, "rhs": 42, "events": 0},
        "changes": dict.fromkeys(MEASURES, -0.25) | {"load_share": None},
    }  # fmt: skip
    table = ladder.tabulate([ran, ran | {"effect": "broken", "reason": "it stopped"}])
    text = ladder.markdown(table)
    assert "| low | 4 | 9 | 20 | 31 | 0.512 | 7 | 42 | 0 | -25.0% | -25.0% | - | -25.0% |" in text
    assert "| broken | - |" in text
    assert "broken: it stopped" in text
