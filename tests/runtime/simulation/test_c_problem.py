"""The scaled problem as C: the graph's values, CasADi's own derivative of the graph, a model of its own each."""

import ctypes
from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from ltcgear.generated import store
from ltcgear.generated.errors import LtcgearError
from ltcgear.runtime.model.building import external
from ltcgear.runtime.model.function import Kernel
from ltcgear.runtime.model.library import Library
from ltcgear.runtime.simulation.methods import stepper
from ltcgear.runtime.simulation.methods.c_problem import compiled_problem, layout, problem_c, scaled_problem

from ..models import case
from ..variants import BEARING_FRICTION, FRICTION, GRAVITY
from .test_integrate import with_counters

OVER_TIME = ("-loads.input.speed", 'loads.input.speed_over_time = [["0 s", "10 rpm"], ["1 s", "90 rpm"]]')
CASES = {
    "plain": ("psh",),
    "losses": ("rig-2mw", *FRICTION, *BEARING_FRICTION, GRAVITY),
    "signals": ("psh", *OVER_TIME),
}


def served(library):
    """The functions that an integrator finds in the problem's library, by name."""
    compiled_problem(library)
    path = store.library(problem_c(library), store.compiler())
    return {name: Kernel(ca.external(name, str(path))) for name in ("dae", "daeF", "quadF", "jacF")}


def point(c, seed):
    """A segment's own time, z, and an integrator's parameters; signals change by their own size."""
    random = np.random.default_rng(seed)
    part = {name: random.uniform(0.5, 1.5, size) for name, size in layout(c.library).items()}
    part |= {"origin": c.at.x, "p": c.p, "scale": 1e-7 * part["scale"]}
    return [random.uniform(), random.normal(size=len(c.at.x)), [], np.concatenate(list(part.values())), []]


@pytest.mark.parametrize("settings", CASES.values(), ids=CASES)
def test_the_problem_in_c_is_the_graph_and_its_derivative(settings):
    c = case(*settings)
    functions = served(c.library)
    graph = scaled_problem(c.library, c.library.graphs, ca.SX)
    z = graph["x"]
    given = [graph["t"], z, ca.SX(0, 1), graph["p"], ca.SX(0, 1)]
    jacobian = ca.Function("jacobian", given, [ca.densify(ca.jacobian(graph["ode"], z))])
    wanted = Kernel(ca.Function("wanted", given, [graph["ode"], graph["quad"]])), Kernel(jacobian)
    inside = functions["jacF"].function.sparsity_out(0)
    for seed in range(3):
        at = point(c, seed)
        ode, power = wanted[0](*at)
        matrix = wanted[1](*at)[0].reshape(len(ode), len(ode), order="F")
        shown = np.zeros_like(matrix)
        shown[inside.get_triplet()] = functions["jacF"](*at)[0]
        assert np.abs(functions["daeF"](*at)[0] - ode).max() <= 1e-10 * np.abs(ode).max() > 0  # products are fused in C
        assert functions["quadF"](*at)[0] == pytest.approx(power, rel=1e-9)
        assert functions["dae"](*at)[0] == pytest.approx(functions["daeF"].results[0], rel=1e-15)
        assert functions["dae"].results[2] == pytest.approx(functions["quadF"].results[0], rel=1e-15)
        size = np.maximum(np.abs(matrix).max(axis=1, keepdims=True), 1e-300)
        assert (np.abs(shown - matrix) / size).max() < 1e-10


def test_signals_go_on_at_their_rates_within_a_segment():
    c = case(*CASES["signals"])
    rate = served(c.library)["daeF"]
    t, z, _, given, _ = point(c, 0)
    ends = np.cumsum(list(layout(c.library).values()))
    part = dict(zip(layout(c.library), np.split(given, ends[:-1]), strict=True))
    begun = rate(0.0, z, [], given, [])[0].copy()
    moved = rate(t, z, [], given, [])[0].copy()
    part["s"][len(c.library.manifest.levels) :] += part["slope"] * part["duration"] * t
    assert np.abs(moved - rate(0.0, z, [], given, [])[0]).max() <= 1e-12 * np.abs(moved).max()
    assert np.abs(moved - begun).max() > 1e-3 * np.abs(begun).max()


def test_two_models_of_one_shape_do_not_share_what_is_bound():
    c = case("rig-2mw")
    artifact = replace(c.library.artifact, c=with_counters(c.library.artifact.c))
    path = store.library(artifact.c, store.compiler())
    other = Library(artifact.manifest, path, external(path), artifact, ctypes.CDLL(str(path)))
    one, two = served(c.library)["daeF"], served(other)["daeF"]
    called = ctypes.CDLL(str(path)).ltcgear_called
    called.restype, called.argtypes = ctypes.c_longlong, [ctypes.c_int]
    before = called(0)
    one(*point(c, 0))
    assert called(0) == before
    two(*point(c, 0))
    assert called(0) == before + 1


@pytest.mark.parametrize(
    ("method", "most", "cause"), [("cvodes", 2, "CV_TOO_MUCH_WORK"), ("idas", 10, "IDA_TOO_MUCH_WORK")]
)
def test_a_failure_names_its_cause_and_leaves_the_next_run_unharmed(monkeypatch, method, most, cause):
    c = case("psh")
    whole = c.run(method=method, rtol=1e-5, t_end=0.02)
    with monkeypatch.context() as patch:
        patch.setattr(stepper, "MOST_STEPS", most)
        assert cause in c.run(method=method, rtol=1e-5, t_end=0.02).status
    again = c.run(method=method, rtol=1e-5, t_end=0.02)
    assert again.counts == whole.counts
    assert (again.x == whole.x).all()


def test_a_compiler_that_has_gone_is_told(monkeypatch):
    c = case("psh")
    monkeypatch.setattr(store, "compiler", lambda: None)
    with pytest.raises(LtcgearError, match="compiler is gone"):
        compiled_problem(c.library)
