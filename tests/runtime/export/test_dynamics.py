"""Right-hand side and Jacobian for other people's solvers, against the contract, closed forms and the march."""

import copy
import pickle
from concurrent.futures import ThreadPoolExecutor
from dataclasses import replace
from time import perf_counter

import numpy as np
import pytest
from ltcgear.generated import store
from ltcgear.generated.errors import CompileError, LtcgearError
from ltcgear.runtime import Dynamics, build
from ltcgear.runtime.model.function import Kernel
from ltcgear.runtime.model.phase_wrapping import Clocks
from ltcgear.runtime.model.rows import Batch, over_time
from ltcgear.symbolic.emit.pipeline import generate
from scipy.integrate import solve_ivp
from sksundae.cvode import CVODE

from ..models import case

GAP = ('effects.contact = "backlash"', 'stages.psh.mesh.backlash = "0.1 mm"')
FREE = ("-loads.input.speed", 'loads.input.torque = "300 N*m"', 'loads.input.initial_speed = "-300 rpm"')
TURNS_BACK = ("-loads.input.speed", 'loads.input.torque = "0 N*m"', 'loads.input.initial_speed = "-27 rpm"')
RAMP = ("-loads.input.speed", 'loads.input.speed_over_time = [["0 s", "0 rpm"], ["0.02 s", "300 rpm"]]')


def torque(*rows):
    rows = ", ".join(f'["{t} ms", "{value} N*m"]' for t, value in rows)
    return "-loads.output.torque", f"loads.output.torque_over_time = [{rows}]"


RATTLE = (
    'effects.contact = "backlash"',
    *torque((0, -137), (3, 250), (7, -290), (11, 40), (20, -200)),
    "-loads.input.speed",
    'loads.input.speed_over_time = [["0 s", "2400 rpm"], ["4.1 ms", "-900 rpm"], ["9 ms", "-2600 rpm"], '
    '["20 ms", "1100 rpm"]]',
)
"""Loads that change their sign, a speed that turns back: all that is not smooth, at once."""
RACES = (
    'effects.bearing_clearance = "on"',
    'stages.psh.input.bearing.clearance = "50 um"',
    'stages.psh.output.bearing.clearance = "80 um"',
    *GAP,
    *torque((0, -137), (3, 250), (7, -290), (11, 40), (20, -200)),
)


def opened(name, *settings):
    c = case(name, *settings)
    return c, Dynamics(c.library, c.model.values(), c.model.tables)


def march(dynamics, x, times, **options):
    """Integrate from jump to jump with solve_ivp; return outputs at the times, and how many legs events ended."""
    t, rows, events = 0.0, [], 0
    while t < times[-1]:
        assert len(rows) < 500, "no progress"
        until = min(dynamics.hold(t, x), times[-1])
        leg = solve_ivp(dynamics.rhs, (t, until), x, dense_output=True, events=dynamics.events, **options)
        assert leg.success
        events += leg.status == 1
        stop = leg.t[-1]
        inside = times[(times >= t) & ((times < stop) | ((times == stop) & (stop == times[-1])))]
        states = leg.sol(inside).T if len(inside) else np.zeros((0, len(x)))
        rows.append(dynamics.outputs(inside, states))
        t, x = stop, leg.y[:, -1]
    return np.concatenate(rows), events


# --- the same numbers


@pytest.mark.parametrize("settings", [(), FREE, RATTLE, GAP], ids=["levels", "free", "rattle", "gap"])
def test_rhs_is_the_contract_s_at_samples_of_a_run(settings):
    """Levels, loads and regimes are those of the march, though found from t and x alone."""
    c, dynamics = opened("psh", *settings)
    path = c.run(method="erk", t_end=0.02, rate=5000.0)
    assert path.turns.max() == 0
    wanted = over_time(c.library, "rhs", path.x, path.s, c.p)
    found = np.array([dynamics.rhs(t, x) for t, x in zip(path.time, path.x, strict=True)])
    assert np.abs(found - wanted).max() <= 1e-14 * np.abs(wanted).max()
    assert 0 < path.levels.mean() < 1
    outputs = over_time(c.library, "outputs", path.x, path.s, c.p)
    assert np.abs(dynamics.outputs(path.time, path.x) - outputs).max() <= 1e-14 * np.abs(outputs).max()
    assert (dynamics.outputs(path.time[7], path.x[7]) == dynamics.outputs(path.time, path.x)[7]).all()


def test_whole_turns_change_nothing_but_rounding():
    c, dynamics = opened("psh")
    path = c.run(method="erk", t_end=0.2, rate=500.0)
    assert np.abs(path.turns).max() > 1
    clocks, rhs = Clocks(c.library.manifest, c.p), Kernel(c.library.functions["rhs"])
    for t, x, s, phi, turns in zip(path.time, path.x, path.s, path.phi, path.turns, strict=True):
        wanted = rhs(x, s, clocks.parameters(int(turns)))[0]
        x[c.state("reference.angle")] = phi + 2 * np.pi * turns
        assert np.abs(dynamics.rhs(t, x) - wanted).max() <= 1e-9 * np.abs(wanted).max()


def test_start_and_names():
    c, dynamics = opened("psh", *RATTLE)
    assert (dynamics.x0 == c.at.x).all()
    assert (dynamics.p == c.p).all()
    assert dynamics.states[0] == "reference.angle"
    assert dynamics.parameters == tuple(name for name, _ in c.library.manifest.parameters)
    names = [dynamics.output_names[i] for i in dynamics.columns("mesh_force")]
    assert names == ["mesh_force:psh.mesh", "mesh_force:psh.mesh.back"]
    assert [dynamics.output_names[i] for i in dynamics.columns("mesh_force:psh.mesh.back")] == names[1:]
    assert [event.name for event in dynamics.events] == ["hold.psh.mesh", "hold.psh.mesh.back"]


@pytest.mark.parametrize(("name", "settings"), [("psh", FREE), ("psh", RATTLE), ("lsp", ())])
def test_jacobian_is_the_difference_quotient(name, settings):
    c, dynamics = opened(name, *settings)
    rng = np.random.default_rng(3)
    for t in rng.uniform(0, 0.02, 4):
        x = dynamics.x0 + dynamics.sizes * rng.uniform(-1, 1, len(c.at.x))
        dynamics.hold(t, x)
        step = 1e-3 * dynamics.sizes
        quotient = np.array(
            [(dynamics.rhs(t, x + h) - dynamics.rhs(t, x - h)) / (2 * h.sum()) for h in np.diag(step)]
        ).T
        weight = dynamics.sizes[None, :] / dynamics.sizes[:, None]
        jacobian = dynamics.jac(t, x)
        assert np.abs((jacobian - quotient) * weight).max() <= 1e-5 * np.abs(jacobian * weight).max()
        assert (dynamics.jac_sparse(t, x).toarray() == jacobian).all()
        dynamics.release()


# --- other solvers


CASES = {
    "levels": ("psh", (), 0),
    "loads over time and regimes": ("psh", RATTLE, None),
    "races and teeth": ("psh", RACES, None),
    "free train": ("psh", FREE, None),
    "free train that turns back": ("psh", TURNS_BACK, None),
    "teeth that just touch, at rest": (
        "psh",
        (*GAP, 'loads.output.torque = "0 N*m"', 'loads.input.speed = "0 rpm"'),
        0,
    ),
    "teeth that just touch, torque": ("psh", (*GAP, *torque((0, 0), (20, 1000))), 0),
    "teeth that just touch, ramp": ("psh", (*GAP, *RAMP, 'loads.output.torque = "0 N*m"'), 0),
}


@pytest.mark.parametrize("which", CASES)
def test_solve_ivp_has_the_march_s_forces(which):
    name, settings, wanted = CASES[which]
    c, dynamics = opened(name, *settings)
    path = c.run(method="erk", rtol=1e-9, t_end=0.02, rate=5000.0)
    options = {"method": "DOP853", "rtol": 1e-10, "atol": 1e-10 * dynamics.sizes}
    outputs, events = march(dynamics, dynamics.x0, path.time, **options)
    forces = c.mesh_forces(path)
    assert np.abs(outputs[:, dynamics.columns("mesh_force")] - forces).max() <= 1e-6 * np.abs(forces).max()
    free = path.counts.events if "reference.speed" in dynamics.states else 0
    assert events == (path.counts.regimes + free if wanted is None else wanted)
    assert wanted == 0 or events > 4


def test_bounces_are_neither_lost_nor_doubled():
    """A gear thrown off its mate without damping: Radau and the Jacobian, and a start far from equilibrium."""
    c, dynamics = opened("hard-bounce")
    x = dynamics.x0
    x[c.state("pair.output.u")] *= -9
    path = c.run(method="erk", rtol=1e-9, t_end=0.01, rate=5000.0, at=replace(c.at, x=x))
    options = {"method": "Radau", "jac": dynamics.jac_sparse, "rtol": 1e-7, "atol": 1e-7 * dynamics.sizes}
    outputs, events = march(dynamics, x, path.time, **options)
    forces = c.mesh_forces(path)
    assert events == path.counts.regimes > 20
    assert np.abs(outputs[:, dynamics.columns("mesh_force")] - forces).max() <= 1e-4 * np.abs(forces).max()


def test_cvode_has_the_march_s_forces():
    c, dynamics = opened("lsp")
    path = c.run(method="erk", rtol=1e-9, t_end=0.03, rate=5000.0)

    def rhs(t, x, rate):
        rate[:] = dynamics.rhs(t, x)

    def jac(t, x, rate, matrix):
        matrix[:] = dynamics.jac(t, x)

    t, x, rows = 0.0, dynamics.x0, []
    while t < path.time[-1]:
        until = min(dynamics.hold(t, x), path.time[-1])
        inside = path.time[(path.time >= t) & (path.time <= until)]
        grid = np.unique([t, *inside, (t + until) / 2, until])
        leg = CVODE(rhs, jacfn=jac, rtol=1e-7, atol=1e-7 * dynamics.sizes, max_num_steps=10_000).solve(grid, x)
        assert leg.success
        rows.append(dynamics.outputs(inside, leg.y[np.searchsorted(grid, inside)]))
        t, x = until, leg.y[-1]
    forces, found = c.mesh_forces(path), np.concatenate(rows)[:, dynamics.columns("mesh_force")]
    assert np.abs(found - forces).max() <= 1e-5 * np.abs(forces).max()


# --- what is held


def test_a_given_speed_tells_when_teeth_come_and_go():
    """Eqs 9-11: a pitch lasts the turn of one tooth, and single contact its share."""
    c, dynamics = opened("psh")
    speed, teeth = c.p[dynamics.parameters.index("reference.speed")], 59
    share = Kernel(c.library.functions["phases"])(c.at.x, c.at.s, c.p)[2].item()
    t, x, times = 0.0, dynamics.x0, []
    for _ in range(7):
        t = dynamics.hold(t, x)
        x[c.state("reference.angle")] = speed * t
        times.append(t)
    pitch = 2 * np.pi / (teeth * abs(speed))
    spans = np.diff(times)
    assert spans[::2] + spans[1::2] == pytest.approx(pitch, rel=1e-9)
    assert sorted(spans[:2]) == pytest.approx(sorted([share * pitch, (1 - share) * pitch]), rel=1e-9)


def test_a_ramp_of_speed_tells_when_teeth_come_and_go():
    """The angle is a t^2 / 2, so borders one pitch apart are met at times whose squares are equally spaced."""
    c, dynamics = opened("psh", *GAP, *RAMP, 'loads.output.torque = "0 N*m"')
    gain = 300 * 2 * np.pi / 60 / 0.02
    t, x, times = 0.0, dynamics.x0, []
    while t < 0.02:
        t = dynamics.hold(t, x)
        x[c.state("reference.angle")] = gain * t**2 / 2
        times.append(t)
    assert times[-1] == 0.02  # the ramp's end, to the last bit
    squares = np.array(times[:-1]) ** 2 * gain / 2 * 59 / (2 * np.pi)
    assert squares[2:] - squares[:-2] == pytest.approx(1.0, rel=1e-9)
    x[c.state("reference.angle")] += 1e-3
    assert dynamics.hold(0.5, x) > 0.5


def test_what_is_held_stays_and_goes_on():
    c, dynamics = opened("psh", *RATTLE)
    x, t = dynamics.x0, 0.001
    until = dynamics.hold(t, x)
    inside = dynamics.borders(t, x)
    far = x.copy()
    far[c.state("reference.angle")] += np.pi / 59  # half a pitch: the other level
    assert (inside > 0).all()
    held = dynamics.rhs(t, far)
    ends = [dynamics.rhs(t + k * (until - t), x) for k in (0, 1, 2)]
    # Linear in time, beyond the end too; the reference speed is one of the loads, and its squares are small.
    assert ends[2] - ends[1] == pytest.approx(ends[1] - ends[0], rel=1e-3, abs=1e-6 * np.abs(ends[0]).max())
    assert (ends[1] != ends[0]).any()
    dynamics.release()
    assert np.abs(dynamics.rhs(t, far) - held).max() > 1.0
    with pytest.raises(LtcgearError, match="call hold"):
        dynamics.borders(t, x)


# --- what is given


def test_arguments_are_copied_and_results_are_new():
    _, dynamics = opened("psh")
    x, p = dynamics.x0, dynamics.p.copy()
    kept = x.copy(), p.copy()
    calls = (dynamics.rhs, dynamics.jac, dynamics.outputs)
    for call in calls:
        first = call(0.0, x, p)
        value = first.copy()
        second = call(0.0, x + dynamics.sizes, p)
        assert (first == value).all()
        assert (second != value).any()
        assert not np.shares_memory(first, second)
    assert (x == kept[0]).all()
    assert (p == kept[1]).all()


def test_parameters_are_those_of_the_call():
    c, dynamics = opened("psh")
    x, p = dynamics.x0, dynamics.p.copy()
    p[dynamics.parameters.index("loads.output.torque")] *= 2
    first, other = dynamics.rhs(0.0, x), dynamics.rhs(0.0, x, p)
    s = dynamics._arrays["s"].copy()
    assert (other == Kernel(c.library.functions["rhs"])(x, s, p)[0]).all()
    assert (first != other).any()
    assert (dynamics.rhs(0.0, x) == first).all()
    dynamics.p[:] = p
    assert (dynamics.rhs(0.0, x) == other).all()


def forms(x):
    wide = np.zeros((len(x), 2))
    wide[:, 1] = x
    return {
        "list": list(x), "strided": wide[:, 1], "swapped": x.astype(">f8"), "reversed": x[::-1].copy()[::-1],
        "longdouble": x.astype(np.longdouble), "read-only": np.broadcast_to(x, x.shape), "tuple": tuple(x),
    }  # fmt: skip


def test_other_forms_of_numbers_are_converted():
    _, dynamics = opened("psh")
    x = dynamics.x0
    wanted = dynamics.rhs(0.0, x)
    for name, form in forms(x).items():
        assert (dynamics.rhs(0.0, form) == wanted).all(), name
        assert (dynamics.rhs(0, x, forms(dynamics.p)[name]) == wanted).all(), name
        assert (dynamics.jac(np.float32(0), form) == dynamics.jac(0.0, x)).all(), name
    single = x.astype(np.float32)
    assert (dynamics.rhs(0.0, single) == dynamics.rhs(0.0, single.astype(float))).all()
    whole = np.arange(len(x))
    assert np.array_equal(dynamics.rhs(0.0, whole), dynamics.rhs(0.0, whole.astype(float)), equal_nan=True)


WRONG = {
    "too long": (lambda x: np.append(x, 0.0), r"x: shape \(12,\), must be \(11,\)"),
    "one number": (lambda x: x[:1], r"x: shape \(1,\)"),
    "scalar": (lambda x: 1.0, r"x: shape \(\)"),
    "column": (lambda x: x[:, None], r"x: shape \(11, 1\)"),
    "complex": (lambda x: x + 1e-20j, "x: numbers of type complex128; must be real"),
    "text": (lambda x: ["a"] * 11, "x: numbers of type"),
    "boolean": (lambda x: x > 0, "x: numbers of type bool"),
    "nothing": (lambda x: [None] * 11, "x: numbers of type object"),
    "ragged": (lambda x: [[1.0], [1.0, 2.0]], "x: "),
}


@pytest.mark.parametrize("wrong", WRONG)
def test_wrong_arguments_are_refused(wrong):
    _, dynamics = opened("psh")
    make, message = WRONG[wrong]
    for call in (dynamics.rhs, dynamics.jac, dynamics.hold, dynamics.outputs):
        with pytest.raises(LtcgearError, match=message if call != dynamics.outputs else "x: |t and x: "):
            call(0.0, make(dynamics.x0))
    with pytest.raises(LtcgearError, match=r"^p: "):
        dynamics.rhs(0.0, dynamics.x0, make(dynamics.p))
    for t in (np.zeros(2), 1j, "soon", None):
        with pytest.raises(LtcgearError, match="t: "):
            dynamics.rhs(t, dynamics.x0)


def test_what_is_not_a_number_is_not_hidden():
    c, dynamics = opened("psh")
    x = dynamics.x0
    x[c.state("reference.angle")] = np.nan
    assert not np.isfinite(dynamics.rhs(0.0, x)).all()
    for t, state in ((0.0, x), (np.nan, dynamics.x0), (np.inf, dynamics.x0)):
        with pytest.raises(LtcgearError, match="must be finite"):
            dynamics.hold(t, state)


def test_copies_are_refused():
    for make in (copy.copy, copy.deepcopy, pickle.dumps):
        with pytest.raises(LtcgearError, match="make another"):
            make(opened("psh")[1])


def test_what_does_not_fit_the_model_is_refused(monkeypatch):
    c, dynamics = opened("psh", *RATTLE)
    values, name = c.model.values(), dynamics.parameters[5]
    with pytest.raises(LtcgearError, match=r"speed_over_time is missing"):
        Dynamics(c.library, values)
    with pytest.raises(LtcgearError, match=f"{name} is missing"):
        Dynamics(c.library, {k: v for k, v in values.items() if k != name}, c.model.tables)
    with pytest.raises(LtcgearError, match="finite"):
        Dynamics(c.library, values | {name: np.inf}, c.model.tables)
    with pytest.raises(LtcgearError, match="no output 'mesh_fore'; there are"):
        dynamics.columns("mesh_fore")
    with pytest.raises(LtcgearError, match=r"take y.T"):
        dynamics.outputs(np.zeros(3), np.zeros((11, 3)))
    artifact = generate(c.model)
    monkeypatch.setattr(store, "compiler", lambda: None)
    with pytest.raises(CompileError, match="C compiler"):
        Dynamics(build(artifact), values, c.model.tables)


# --- threads and time


def test_each_thread_has_its_own():
    c = case("lsp")
    several = [opened("lsp")[1] for _ in range(4)]
    rng = np.random.default_rng(1)
    states = [[c.at.x + 1e-6 * rng.uniform(-1, 1, len(c.at.x)) for _ in range(400)] for _ in several]
    alone = [[several[0].rhs(0.0, x) for x in part] for part in states]
    with ThreadPoolExecutor(4) as pool:
        found = pool.map(lambda k: [several[k].rhs(0.0, x) for x in states[k]], range(4))
        assert np.array_equal(alone, list(found))


def test_a_call_costs_little_more_than_its_c():
    """Over the C itself less than four calls of C by ctypes, and less than CasADi's own buffers; all interleaved."""
    c, dynamics = opened("psh")
    x, p, calls = dynamics.x0, c.p, 500
    s = np.zeros(len(c.library.manifest.levels))
    rows, batch, kernel = np.tile(x, (calls, 1)), Batch(c.library, "rhs"), Kernel(c.library.functions["rhs"])
    plain, address = dynamics._run, dynamics._address
    ways = {
        "C": lambda: batch(rows, s, p),
        "ctypes": lambda: [plain(address, 0.0) for _ in range(calls)],
        "kernel": lambda: [kernel(x, s, p)[0].copy() for _ in range(calls)],
        "rhs": lambda: [dynamics.rhs(0.0, x, p) for _ in range(calls)],
    }
    least = dict.fromkeys(ways, np.inf)
    for _ in range(40):
        for name, way in ways.items():
            clock = perf_counter()
            way()
            least[name] = min(least[name], perf_counter() - clock)
    assert least["rhs"] - least["C"] < 4 * least["ctypes"]
    assert least["rhs"] < least["kernel"]
