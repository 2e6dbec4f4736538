"""Integrations: methods against each other, against an exact solution, against energy; failures; real calls."""

import ctypes
from dataclasses import replace

import numpy as np
import pytest
from ltcgear.generated import store
from ltcgear.generated.errors import CompileError, LtcgearError
from ltcgear.runtime.model import cstruct
from ltcgear.runtime.model.building import build, external
from ltcgear.runtime.model.equilibrium import find_equilibrium, start_state
from ltcgear.runtime.model.function import Kernel
from ltcgear.runtime.model.library import Library
from ltcgear.runtime.model.operating_point import OperatingPoint
from ltcgear.runtime.model.rows import over_time
from ltcgear.runtime.model.state_matrix import Equilibrium, mean_levels, state_matrix
from ltcgear.runtime.simulation.dense_output import Chebyshev, Uniform
from ltcgear.runtime.simulation.energy_balance import energy_residual
from ltcgear.runtime.simulation.integrate import integrate
from ltcgear.runtime.simulation.methods import stepper
from ltcgear.runtime.simulation.methods.registry import METHODS
from ltcgear.runtime.simulation.run_settings import RunSettings
from scipy.linalg import expm

from .. import exact
from ..models import TORQUE_DRIVEN, case, run
from ..variants import BEARING_FRICTION, FRICTION, GRAVITY


def residual(c, path, at=None):
    return abs(energy_residual(OperatingPoint(c.library, c.p, at or c.at), path))


INTERPOLATION = {"erk": 3e-6, "rosenbrock": 3e-6} | {name: 1e-6 for name, method in METHODS.items() if method.multistep}
"""What reading between the nodes of a segment may cost, whatever the tolerance."""


def displaced(c, seed=0, size=1e-8):
    """The equilibrium pushed out of its place."""
    x = c.at.x.copy()
    position = c.library.index("")
    axes = [c.library.manifest.states[i].axis for i in position]
    push = np.random.default_rng(seed).normal(size=len(position)) * size
    x[position] += np.where(np.array(axes) == "u", 10 * push, push)
    return Equilibrium(x, c.at.levels, 0.0, 0)


# --- samples on jumps

ON_JUMPS = (
    'effects.lateral = "off"', "stages.psh.input.teeth = 60", "stages.psh.mesh.contact_ratio = 1.5",
    "-loads.input.speed", 'loads.input.speed_over_time = [["0 s", "-60 rpm"], ["9 s", "-60 rpm"]]',
)  # fmt: skip
"""Halves of single and double contact, a jump every 120th of a second; how far the train is, integration must tell."""


@pytest.mark.parametrize("method", ["erk", "cvodes", "sundae"])
def test_a_sample_on_a_jump_is_the_one_before_it(method):
    path = case("psh", *ON_JUMPS).run(method=method, t_end=0.5, rate=120.0, rtol=1e-6)
    assert path.status == "done"
    assert (path.levels[1:, 0] == np.arange(60) % 2).all()


# --- methods against each other


def force_error(c, one, two):
    """Largest difference of any mesh force, relative to its mean."""
    a, b = c.mesh_forces(one), c.mesh_forces(two)
    same = (one.levels == two.levels).all(axis=1)
    assert same.mean() > 0.999
    return (np.abs(a - b)[same].max(axis=0) / np.abs(b).mean(axis=0)).max()


@pytest.mark.parametrize("method", ["idas", "erk", "rosenbrock"])
def test_methods_agree_on_mesh_forces(method):
    c = case("rig-2mw")
    one, two = run("rig-2mw", method=method), run("rig-2mw", method="cvodes")
    assert one.status == two.status == "done"
    assert len(one.time) == round(0.1 * 8192) + 1
    assert force_error(c, one, two) < 1e-4


def test_stiffness_really_makes_the_forces_swing():
    c = case("rig-2mw")
    forces = c.mesh_forces(run("rig-2mw", method="cvodes"))
    assert (np.ptp(forces, axis=0) > 0.02 * np.abs(forces).mean(axis=0)).all()


@pytest.mark.parametrize("method", METHODS)
def test_energy_is_accounted_for(method):
    c, path = case("rig-2mw"), run("rig-2mw", method=method)
    assert residual(c, path) < 1e-5
    assert abs(path.jump_energy) > 1e-4 * abs(path.work) or path.counts.events == 0


def test_methods_agree_on_a_torque_driven_train():
    c = case("rig-2mw", *TORQUE_DRIVEN)
    one, two = (run("rig-2mw", *TORQUE_DRIVEN, method=method) for method in ("erk", "cvodes"))
    assert one.status == two.status == "done"
    assert force_error(c, one, two) < 1e-4
    assert max(residual(c, one), residual(c, two)) < 1e-5


def test_energy_is_accounted_for_with_friction_and_weight():
    settings = (*FRICTION, *BEARING_FRICTION, GRAVITY)
    c, path = case("rig-2mw", *settings), run("rig-2mw", *settings, method="erk")
    assert path.status == "done"
    assert residual(c, path) < 1e-5
    balance = over_time(c.library, "energy", path.x, path.levels, c.p)
    assert (balance[:, 3] > 0).all()


@pytest.mark.parametrize("method", METHODS)
def test_a_rerun_is_the_same_to_the_last_bit(method):
    one, two = (case("psh").run(method=method, rtol=1e-5, t_end=0.05) for _ in range(2))
    assert (one.x == two.x).all()
    assert one.counts == two.counts


def test_a_restart_goes_on_as_if_nothing_had_been():
    c = case("psh")
    whole = c.run(method="erk", rtol=1e-8, t_end=0.1, rate=8000.0)
    middle = Equilibrium(whole.x[400], c.at.levels, 0.0, 0)
    rest = c.run(at=middle, method="erk", rtol=1e-8, t_end=0.05, rate=8000.0)
    same = (rest.levels == whole.levels[400:]).all(axis=1)
    assert same.mean() > 0.99
    difference = np.abs(c.mesh_forces(rest) - c.mesh_forces(whole)[400:])[same]
    assert difference.max() < 1e-5 * np.abs(c.mesh_forces(whole)).mean()
    phase = whole.x[-1, c.state("reference.angle")] - rest.x[-1, c.state("reference.angle")]
    assert abs(phase) < 1e-12 * abs(whole.x[-1, c.state("reference.angle")])


@pytest.mark.parametrize("method", METHODS)
def test_a_run_is_counted(method):
    counts = run("rig-2mw", method=method).counts
    assert counts.rhs > counts.steps > counts.segments > 100
    assert (counts.jacobian > 0) == (method not in ("erk", "adams"))
    assert counts.events == run("rig-2mw", method="cvodes").counts.events > 200


# --- against the exact solution of a piecewise linear train


@pytest.fixture(scope="module")
def train():
    c = case("psh", *exact.SETTINGS)
    return c, exact.Train(c.scene)


def exact_error(c, train, path):
    """Largest error of mesh force, relative to its mean, and of the generator's twist, relative to its swing."""
    wanted = train.solve(path.time)
    given = path.x[:, [c.state(name) for name in exact.FREE]]
    clear = np.abs(path.time[:, None] - train.switchings(path.time[-1])[0]).min(axis=1) > 1e-9
    k = train.mesh.stiffness(path.levels[:, 0])
    force = k * (wanted[:, :3] @ train.pull) + train.c * (wanted[:, 3:] @ train.pull)
    shown = c.mesh_forces(path)[:, 0]
    twist = np.abs(given - wanted[:, :3]).max(axis=0) / np.ptp(wanted[:, :3], axis=0)
    return np.abs(shown - force)[clear].max() / np.abs(force).mean(), twist.max()


def end_error(c, train, path):
    """Error of the last state, which is a segment's end, relative to the swings."""
    wanted = train.solve(path.time)
    names = [*exact.FREE, *(f"{name}.rate" for name in exact.FREE)]
    given = path.x[-1, [c.state(name) for name in names]]
    return np.linalg.norm((given - wanted[-1]) / np.ptp(wanted, axis=0))


def test_the_equilibrium_of_the_exact_train(train):
    c, by_hand = train
    assert c.at.x[[c.state(name) for name in exact.FREE]] == pytest.approx(by_hand.equilibrium(), rel=1e-10)


@pytest.mark.parametrize("method", METHODS)
def test_the_exact_solution_is_met_at_every_sample(train, method):
    c, by_hand = train
    # 30 kHz: samples lie everywhere between the Chebyshev nodes of a segment.
    path = c.run(method=method, rtol=1e-8, rate=30e3, t_end=0.05)
    assert path.status == "done"
    assert path.counts.events > 50
    force, twist = exact_error(c, by_hand, path)
    assert force < INTERPOLATION[method]
    assert twist < 1e-5


@pytest.mark.parametrize("speed", ["638.904 rpm", "-9000 rpm", "3 rpm"])
def test_the_exact_solution_at_other_speeds(speed):
    c = case("psh", *exact.SETTINGS, f'loads.input.speed = "{speed}"')
    path = c.run(method="erk", rtol=1e-8, rate=20e3, t_end=0.05)
    assert max(exact_error(c, exact.Train(c.scene), path)) < 2e-5


@pytest.mark.parametrize("method", METHODS)
def test_errors_fall_with_the_tolerance(train, method):
    c, by_hand = train
    paths = [c.run(method=method, rtol=rtol, t_end=0.05) for rtol in (1e-3, 1e-5, 1e-7)]
    forces = [exact_error(c, by_hand, path)[0] for path in paths]
    assert forces[0] > 3 * forces[1]
    assert forces[1] > 3 * forces[2] or forces[2] < INTERPOLATION[method]
    ends = [end_error(c, by_hand, path) for path in paths]
    assert ends[0] > 10 * ends[1] > 100 * ends[2]
    assert paths[0].counts.steps < paths[1].counts.steps < paths[2].counts.steps


def test_more_samples_change_no_sample():
    coarse, fine = (run("rig-2mw", method="cvodes", rate=rate) for rate in (8192.0, 3 * 8192.0))
    assert np.allclose(coarse.time, fine.time[::3], rtol=0, atol=1e-15)
    c = case("rig-2mw")
    one, two = c.mesh_forces(coarse), c.mesh_forces(fine)[::3]
    same = (coarse.levels == fine.levels[::3]).all(axis=1)
    assert same.mean() > 0.999
    assert np.abs(one - two)[same].max() < 1e-6 * np.abs(one).mean()


@pytest.mark.parametrize(("count", "turn"), [(16, 8.0), (24, 16.0)])
def test_nodes_interpolate_a_cosine(count, turn):
    nodes = Chebyshev(count)
    times = np.linspace(0, 1, 997)
    # The fastest mode turns by this angle a segment at most.
    wave = np.cos(turn * nodes.points + 0.3)
    assert np.abs(nodes.matrix(times) @ wave - np.cos(turn * times + 0.3)).max() < 2e-9
    assert np.abs(nodes.matrix(nodes.points) - np.eye(count + 1)).max() == 0.0


def test_samples_on_nodes_are_picked_out():
    nodes = Uniform(5)
    values = np.arange(6.0) ** 2
    assert (nodes.matrix(np.array([0.2, 0.6 + 1e-13, 1.0])) @ values == [1.0, 9.0, 25.0]).all()


@pytest.mark.parametrize("samples", [1, 100, 256, 257, 1000])
@pytest.mark.parametrize("method", ["erk", "cvodes"])
def test_any_number_of_samples_without_switching(method, samples):
    c = case("lin-parker-4")
    at = displaced(c)
    path = c.run(at=at, method=method, rtol=1e-8, rate=1e5, t_end=samples / 1e5)
    A = state_matrix(c.library, c.at.x, c.at.levels, c.p)
    assert path.status == "done"
    assert path.time == pytest.approx(np.arange(samples + 1) / 1e5)
    assert path.end == path.time[-1]
    wanted = expm(A * path.end) @ at.x
    assert np.abs(path.x[-1] - wanted).max() < 1e-4 * np.abs(wanted).max()
    assert residual(c, path, at) < 1e-4


# --- free vibration


@pytest.mark.parametrize("method", METHODS)
def test_without_damping_energy_stays(method):
    c = case("lin-parker-4")
    at = displaced(c)
    path = c.run(at=at, method=method, rtol=1e-8, t_end=0.02)
    balance = over_time(c.library, "energy", path.x, path.levels, c.p)
    energy = balance[:, 0] + balance[:, 1]
    assert path.status == "done"
    assert energy[0] > 0
    assert np.abs(energy / energy[0] - 1).max() < 2e-4
    assert np.ptp(balance[:, 1]) > 0.5 * energy[0]
    assert path.work == pytest.approx(0.0, abs=1e-12 * energy[0])


def test_small_free_vibrations_are_the_matrix_exponential():
    c = case("lin-parker-4")
    at = displaced(c)
    path = c.run(at=at, method="erk", rtol=1e-9, t_end=0.005, rate=20e3)
    A = state_matrix(c.library, c.at.x, c.at.levels, c.p)
    wanted = np.array([expm(A * t) @ at.x for t in path.time])
    size = np.abs(wanted).max(axis=0)
    assert (np.abs(path.x - wanted).max(axis=0) / size).max() < 2e-5


# --- failures


def test_stiffness_that_varies_faster_than_any_mode_swings_is_resolved():
    """A table of one torque changes nothing but where samples are read: between nodes in place of on them."""
    smooth = ('effects.mesh_stiffness = "smooth"', "stages.psh.mesh.transition = 0.1")
    rows = '[["0 s", "-1.06e4 N*m"], ["10 s", "-1.06e4 N*m"]]'
    plain = case("psh", *smooth)
    tabled = case("psh", *smooth, f"loads.output.torque_over_time = {rows}", "-loads.output.torque")
    one, two = (c.mesh_forces(c.run(method="erk", rtol=1e-6, t_end=0.05)) for c in (plain, tabled))
    assert np.sqrt(np.mean((one - two) ** 2)) < 2e-6 * one.std()


def test_a_failing_solver_is_a_status(monkeypatch):
    monkeypatch.setattr(stepper, "MOST_STEPS", 2)
    path = case("psh").run(method="cvodes", rtol=1e-8)
    assert path.status.startswith("cvodes stopped at t = ")
    assert "rtol 1e-08" in path.status
    assert "--method" in path.status
    assert len(path.time) == len(path.x) == len(path.levels) >= 1
    assert path.end < 0.1


@pytest.mark.parametrize("method", ["erk", "cvodes", "idas", "rosenbrock"])
def test_gears_pulled_into_each_other_stop_the_run_and_keep_the_data(monkeypatch, method):
    monkeypatch.setattr(stepper, "MOST_STEPS", 10_000)
    # On the wrong flank the mesh pulls 1.18e5 N; soft bearings let the base circles meet after some milliseconds.
    soft = [f'stages.psh.{part}.bearing.stiffness = "1e6 N/m"' for part in ("input", "output")]
    c = case("psh", *soft, 'stages.psh.mesh.flank = "printed"')
    x = start_state(c.library, c.p)
    at = Equilibrium(x, mean_levels(c.library, x, c.p), 0.0, 0)
    path = c.run(at=at, method=method, rtol=1e-6, t_end=0.1, rate=1e5)
    assert path.status.startswith(f"{method} stopped at t = ")
    assert 1e-3 < path.end < 0.05
    assert path.end - 1e-5 < path.time[-1] <= path.end
    assert len(path.time) == len(path.x) == len(path.levels) > 100
    assert np.isfinite(path.x).all()
    assert np.isfinite(over_time(c.library, "outputs", path.x, path.levels, c.p)).all()


def test_an_unknown_method_is_refused():
    with pytest.raises(LtcgearError, match="euler"):
        case("psh").run(method="euler")


def test_a_run_shorter_than_a_sample_is_refused():
    with pytest.raises(LtcgearError, match="shorter than one sample"):
        case("lin-parker-3").run(t_end=1e-9)


def test_progress_is_told():
    told = []
    case("psh").run(method="erk", rtol=1e-6, told=told.append)
    assert told
    assert all(0 < t <= 0.1 for t in told)


# --- what is really called


COUNTER = """
static long long ltcgear_calls[2];
CASADI_SYMBOL_EXPORT long long ltcgear_called(int which) { return ltcgear_calls[which]; }
"""


def with_counters(text):
    """The C text with a counter in `rhs` and in `jac_rhs`."""
    for i, name in enumerate(("rhs", "jac_rhs")):
        head = f"CASADI_SYMBOL_EXPORT int {name}(const casadi_real** arg, casadi_real** res, casadi_int* iw, "
        head += "casadi_real* w, int mem){"
        assert text.count(head) == 1
        text = text.replace(head, (COUNTER if i == 0 else "") + head + f" ++ltcgear_calls[{i}];")
    return text


@pytest.fixture(scope="module")
def counted():
    """A case whose compiled functions count their calls, and how to read the counts."""
    c = case("rig-2mw")
    artifact = replace(c.library.artifact, c=with_counters(c.library.artifact.c))
    path = store.library(artifact.c, store.compiler())
    library = Library(artifact.manifest, path, external(path), artifact, ctypes.CDLL(str(path)))
    read = ctypes.CDLL(str(path)).ltcgear_called
    read.restype, read.argtypes = ctypes.c_longlong, [ctypes.c_int]
    return c, library, read


@pytest.mark.parametrize("method", ["cvodes", "idas"])
def test_the_compiled_functions_are_what_is_integrated(counted, method):
    c, library, read = counted
    before = [read(i) for i in range(2)]
    path = integrate(OperatingPoint(library, c.p, c.at), RunSettings(0.05, 8192.0, method, 1e-6))
    rhs, jacobian = (read(i) - b for i, b in zip(range(2), before, strict=True))
    assert path.status == "done"
    assert 0.9 * path.counts.rhs <= rhs <= 1.5 * path.counts.rhs + 10 * path.counts.segments
    assert 0.9 * path.counts.jacobian <= jacobian <= 1.5 * path.counts.jacobian + 10 * path.counts.segments


@pytest.mark.parametrize("method", ["cvodes", "erk"])
def test_without_a_compiler_nothing_is_integrated(monkeypatch, method):
    c = case("lsp")
    monkeypatch.setattr(store, "compiler", lambda: None)
    cstruct.engine.cache_clear()
    library = build(c.library.artifact)
    assert library.engine == "CasADi virtual machine"
    assert c.library.engine == "compiled C"
    at = find_equilibrium(library, c.p)
    with pytest.raises(CompileError, match="needs a C compiler") as refused:
        integrate(OperatingPoint(library, c.p, at), RunSettings(0.1, 8192.0, method, 1e-7))
    assert refused.value.exit_code == 3


def test_both_engines_evaluate_alike():
    c = case("rig-2mw")
    x = displaced(c, size=1e-5).x
    levels = np.linspace(0, 1, len(c.library.manifest.levels))
    for name, arguments in (("rhs", (x, levels, c.p)), ("outputs", (x, levels, c.p)), ("phases", (x, levels, c.p))):
        one = Kernel(c.library.functions[name])(*arguments)[0]
        two = Kernel(c.library.graphs[name])(*arguments)[0]
        assert np.abs(one - two).max() <= 1e-11 * np.abs(one).max()
