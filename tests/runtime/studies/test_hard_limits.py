"""Hard cases about limits, equilibrium and symmetry, each with every method."""

from functools import cache

import numpy as np
import pytest
from ltcgear.generated.errors import LtcgearError
from ltcgear.runtime.model.building import build
from ltcgear.runtime.model.dynamic_relaxation import relax
from ltcgear.runtime.results.dataset import make_dataset
from ltcgear.runtime.simulation.integrate import integrate
from ltcgear.runtime.simulation.method_limits import check_explicit
from ltcgear.runtime.simulation.output_reader import sampled
from ltcgear.runtime.simulation.run_settings import RunSettings
from ltcgear.runtime.studies.selftest import limit_cases, symmetry_cases
from ltcgear.runtime.studies.selftest.case import Bench
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.emit.pipeline import obtain
from ltcgear.symbolic.scene.load import load_scene

CASES = {case.name: case for case in (*limit_cases.CASES, *symmetry_cases.CASES)}


@cache
def built(name, changes):
    model = build_model(load_scene(name, dict(changes)))
    return Bench(build(obtain(model)), model.values(), model.tables)


def open_bench(name, changes):
    """Build a scene on the test bench, once a session."""
    return built(name, tuple(sorted(changes.items())))


@pytest.mark.parametrize("method", ["erk", "cvodes"])
def test_a_run_in_which_gears_collide_keeps_only_finite_values(method):
    bench = open_bench("psh", limit_cases.CLOSING)
    path = integrate(bench.point, RunSettings(0.2, 8192.0, method, 1e-5, tables=bench.tables))
    assert 0.05 < path.end < 0.15
    assert path.status.startswith(f"{method} stopped at t = 0.0")
    assert "gears of psh.mesh come so close" in path.status
    data = make_dataset(bench.library, bench.p, sampled(bench.library, path, bench.p))
    assert np.isfinite(data["mesh_force"].values).all()
    assert np.isfinite(path.x).all()
    assert len(path.time) > 100


def test_a_long_run_of_a_train_that_is_not_stiff_is_not_refused():
    bench = open_bench("psh", {})
    check_explicit(bench.point, RunSettings(3e4, method="erk"))
    with pytest.raises(LtcgearError, match=r"psh\.(input|output|mesh)"):
        check_explicit(bench.point, RunSettings(1e7, method="erk"))


def test_what_falls_through_a_gap_is_held_and_what_nothing_stops_is_told():
    def wall(q):
        """A unit weight, and a spring beyond 5."""
        deep = np.maximum(q - 5.0, 0.0)
        return 1.0 - deep, np.diag((q > 5.0).astype(float))

    assert relax(wall, np.zeros(1), 1e-12) == pytest.approx([6.0])
    assert relax(lambda q: (np.ones(1), np.zeros((1, 1))), np.zeros(1), 1e-12) is None
