"""Ties: what rounding alone tells apart stands by name."""

import numpy as np
import pytest
from ltcgear.runtime.model.ties import largest_first, order_by_size


@pytest.mark.parametrize("seed", range(5))
def test_rounding_does_not_change_an_order(seed):
    sizes = np.array([0.0, 1.0, 1 / 3, 0.0, 1 / 3, 5.0, 1.0])
    names = ["lsp.planet.10", "b", "d.2", "lsp.planet.9", "d.1", "z", "a"]
    noise = np.random.default_rng(seed).uniform(-1e-14, 1e-14, sizes.size)
    assert [names[k] for k in order_by_size(sizes + noise, names)] == [
        "z", "a", "b", "d.1", "d.2", "lsp.planet.9", "lsp.planet.10",
    ]  # fmt: skip
    assert order_by_size(sizes + noise) == [5, 1, 6, 2, 4, 0, 3]


def test_what_differs_by_more_is_ordered_by_size():
    assert order_by_size([1.0, 1.0 + 1e-6, 1e-6, 3e-6], ["a", "b", "c", "d"]) == [1, 0, 3, 2]
    assert list(largest_first({"a": 0.1, "b": 0.2, "c": 0.1 + 1e-15})) == ["b", "a", "c"]


def test_what_is_not_finite_has_its_place():
    assert order_by_size([np.nan, 1.0, np.inf, np.nan, np.inf, -np.inf], list("fedcba")) == [4, 2, 1, 5, 3, 0]
    assert order_by_size([]) == []
    assert order_by_size([0.0, 0.0]) == [0, 1]
