"""The explicit pair: order conditions of its tableau, and the order of what it computes."""

import numpy as np
import pytest

from .. import butcher
from ..models import case

INNER = np.hstack([butcher.array("A"), np.zeros((7, 1))])
NODES = butcher.array("NODE")


def trees(order):
    """Weights of stages and what they must add up to, for all rooted trees of an order (Butcher)."""
    c, a, one = NODES, INNER, np.ones(7)
    found = {
        1: [(one, 1)],
        2: [(c, 2)],
        3: [(c**2, 3), (a @ c, 6)],
        4: [(c**3, 4), (c * (a @ c), 8), (a @ c**2, 12), (a @ a @ c, 24)],
        5: [
            (c**4, 5), (c**2 * (a @ c), 10), ((a @ c) ** 2, 20), (c * (a @ c**2), 15), (c * (a @ a @ c), 30),
            (a @ c**3, 20), (a @ (c * (a @ c)), 40), (a @ a @ c**2, 60), (a @ a @ a @ c, 120),
        ],
    }  # fmt: skip
    return found[order]


def test_rows_add_up_to_the_nodes():
    assert INNER.sum(axis=1) == pytest.approx(NODES, abs=4e-15)


@pytest.mark.parametrize("order", range(1, 6))
def test_weights_fulfil_the_order_conditions(order):
    for values, below in trees(order):
        assert butcher.array("WEIGHT") @ values == pytest.approx(1 / below, abs=1e-14)
        if order < 5:  # the embedded method's error
            assert butcher.array("MISS") @ values == pytest.approx(0.0, abs=1e-14)
    assert max(abs(butcher.array("MISS") @ values) for values, _ in trees(5)) > 1e-5


@pytest.mark.parametrize("part", [0.1, 0.5, 0.9, 1.0])
@pytest.mark.parametrize("order", range(1, 5))
def test_dense_output_fulfils_the_order_conditions(order, part):
    weights = butcher.array("DENSE") @ part ** np.arange(1, 5)
    for values, below in trees(order):
        assert weights @ values == pytest.approx(part**order / below, abs=1e-13)


def test_errors_fall_with_the_fifth_power_of_the_step():
    c = case("psh", 'effects.mesh_stiffness = "mean"', 'effects.eccentricity = "on"',
             'stages.psh.input.eccentricity = { radius = "20 um" }')  # fmt: skip
    runs = [c.run(method="erk", rtol=rtol, t_end=0.05, rate=8192.0) for rtol in (1e-6, 1e-8, 1e-12)]
    steps = [path.counts.steps for path in runs]
    errors = [np.abs(path.x - runs[-1].x).max(axis=0)[1:].max() for path in runs[:2]]
    assert np.log(errors[0] / errors[1]) / np.log(steps[1] / steps[0]) == pytest.approx(5, abs=1)
