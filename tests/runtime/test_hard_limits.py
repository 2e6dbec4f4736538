"""Hard cases about limits, equilibrium and symmetry, each with every method."""

from functools import cache

import pytest
from ltcgear.generated.errors import LtcgearError
from ltcgear.runtime.hard import limits, symmetry
from ltcgear.runtime.hard.case import Bench
from ltcgear.runtime.library import build
from ltcgear.runtime.stepper import METHODS
from ltcgear.symbolic.build import build_model
from ltcgear.symbolic.pipeline import obtain
from ltcgear.symbolic.scene import load_scene

CASES = {case.name: case for case in (*limits.CASES, *symmetry.CASES)}
REFUSED = {
    ("tiny-inertia-long", "erk"): r"erk would need about \de\+\d+ steps: speck \(u\) .* use --method rosenbrock",
    ("tiny-inertia-long", "idas"): r"idas stopped at t = 0 s .*try another --method",
}
"""What may refuse a case, and the reason it must give."""


@cache
def built(name, changes):
    model = build_model(load_scene(name, dict(changes)))
    return Bench(build(obtain(model)), model.values(), model.tables)


def open_bench(name, changes):
    """Build a scene on the test bench, once a session."""
    return built(name, tuple(sorted(changes.items())))


RUNS = [(name, method) for name, case in CASES.items() for method in (METHODS if case.integrates else ("-",))]


@pytest.mark.parametrize(("name", "method"), RUNS)
def test_a_case_is_right_or_refused_with_its_reason(name, method):
    if (name, method) in REFUSED:
        with pytest.raises(LtcgearError, match=REFUSED[name, method]):
            list(CASES[name].check(open_bench, method, False))
        return
    found = list(CASES[name].check(open_bench, method, False))
    assert found
    assert [(item.what, item.value, item.limit) for item in found if not item.right] == []
