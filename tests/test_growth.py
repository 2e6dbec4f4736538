"""Work grows in proportion to planets and stages, and the operations of the rig stay what they are."""

import json
from importlib import import_module

import pytest
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.emit.c_text import emit
from ltcgear.symbolic.mechanics.equations import derive
from ltcgear.symbolic.scene.load import load_scene

from regenerate import ROOT

OPERATIONS = {"rhs": 1142, "motion": 1546, "jac_rhs": 4683}
"""Of rig-2mw."""


@pytest.fixture(scope="module")
def growth():
    with pytest.MonkeyPatch.context() as patch:
        patch.syspath_prepend(ROOT)
        yield import_module("benchmarks.growth.__main__")


@pytest.fixture(scope="module")
def trains(growth):
    return import_module("benchmarks.growth.scenes")


def test_operations_of_the_rig():
    model = build_model(load_scene("rig-2mw"))
    counts = emit(model, derive(model)).manifest.functions
    for name, operations in OPERATIONS.items():
        assert counts[name].operations == pytest.approx(operations, rel=0.1), name


SIZES = {"planets": [(3, 1), (6, 1), (12, 1)], "stages": [(3, 2), (3, 4), (3, 8)]}


@pytest.mark.parametrize(("over", "sizes"), SIZES.items())
def test_operations_and_bytes_grow_in_proportion(growth, trains, over, sizes):
    rows = []
    for planets, stages in sizes:
        model = build_model(trains.train(planets, stages))
        artifact = emit(model, derive(model))
        counts = artifact.manifest.functions
        rows.append({
            "planets": planets, "stages": stages, "bytes": len(artifact.c),
            "operations": counts["motion"].operations, "jacobian": counts["jac_rhs"].operations,
        })  # fmt: skip
    for key in ("operations", "jacobian", "bytes"):
        assert 0.8 <= growth.exponent(rows, over, key) <= 1.1, key


def test_an_exponent_is_that_of_a_power(growth):
    rows = [{"planets": n, "ns": 7.0 * n**1.7} for n in (1, 2, 5)]
    assert growth.exponent(rows, "planets", "ns") == pytest.approx(1.7, rel=1e-12)


def test_the_page_is_of_the_data(growth):
    page, data = growth.PAGE.read_text("utf-8"), json.loads(growth.DATA.read_text("utf-8"))
    assert page.split(growth.BEGIN)[1].split(growth.END)[0] == growth.page_table(data)
    assert [(row["planets"], row["stages"]) for rows in data.values() for row in rows] == [
        size for _, sizes in growth.SWEEPS for size in sizes
    ]
    for over, rows in data.items():
        for key in ("operations", "jacobian", "bytes"):
            assert growth.exponent(rows, over, key) <= 1.1
