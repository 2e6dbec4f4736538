"""Floquet multipliers: Mathieu's and Meissner's equations, Liouville, symmetry, and time simulation."""

from dataclasses import replace
from math import pi

import numpy as np
import pytest
from ltcgear.generated.errors import LtcgearError, SolverError
from ltcgear.runtime.linear.chart import RPM, draw_up
from ltcgear.runtime.linear.floquet import find_monodromies, find_multipliers, settle
from ltcgear.runtime.linear.periodic import vary
from ltcgear.runtime.model.operating_point import OperatingPoint
from ltcgear.runtime.simulation.integrate import integrate
from ltcgear.runtime.simulation.matrix_exponential import Exact
from ltcgear.runtime.simulation.run_settings import RunSettings
from scipy.linalg import expm
from scipy.optimize import brentq
from scipy.special import mathieu_a, mathieu_b

from ..models import TORQUE_DRIVEN, case
from ..variants import FOURIER, SMOOTH, TABLE

UNDAMPED = ('effects.damping = "off"', 'effects.mesh_damping = "off"')
ALONE = (  # one gear turns at a held speed, the other swings on the mesh
    'effects.lateral = "off"',
    *(f'stages.psh.{part}.support = "rigid"' for part in ("input", "output")),
    *(f"-stages.psh.{part}.bearing" for part in ("input", "output")),
)
FACTOR = 1.8
SQUARE = (*ALONE, *UNDAMPED, f"stages.psh.mesh.double_factor = {FACTOR}", "stages.psh.mesh.contact_ratio = 1.5")
ONE_HARMONIC = (*SQUARE, 'effects.mesh_stiffness = "fourier"', "stages.psh.mesh.harmonics = 1")


def multipliers(c, mesh=None, speed=None, variation=1.0):
    return find_multipliers(vary(c.library, c.p, mesh, speed), variation)


def swing(c):
    """The angular frequency of the gear that swings on its mesh's mean stiffness, from the scene's numbers."""
    mean = 0.96e8 / r_b(59) ** 2 * (1 + FACTOR) / 2
    return np.sqrt(mean * r_b(21) ** 2 / c.model.values()["psh.output.inertia"])


def r_b(teeth):
    """Base radius [m] of a gear of the pair: module 9 mm, 20 deg normal, helix 8 deg."""
    beta = np.radians(8)
    return teeth * 9e-3 / np.cos(beta) / 2 * np.cos(np.arctan(np.tan(np.radians(20)) / np.cos(beta)))


def meshing(mesh_frequency, c):
    """The held speed [rad/s] at which teeth of the input mesh with some angular frequency."""
    return np.sign(c.scene.loads["input"].speed) * mesh_frequency / 59


@pytest.mark.parametrize(
    ("value", "order", "trace"), [(mathieu_b, 1, -2), (mathieu_a, 1, -2), (mathieu_b, 2, 2), (mathieu_a, 2, 2)]
)
def test_tongues_of_mathieus_equation(value, order, trace):
    """y'' + (a - 2 q cos 2x) y = 0 has a periodic solution on a = a_n(q) and b_n(q)."""
    c = case("psh", *ONE_HARMONIC)
    w = swing(c)
    part = 2 / pi * (FACTOR - 1) / ((1 + FACTOR) / 2)  # Fourier's first amplitude of a square wave, over the mean
    a = brentq(lambda a: value(order, part * a / 2) - a, 0.4 * order**2, 2.2 * order**2, xtol=1e-14)
    found = multipliers(c, speed=meshing(2 * w / np.sqrt(a), c))
    assert np.trace(found.matrix) == pytest.approx(trace, abs=1e-6)
    inside = multipliers(c, speed=meshing(2 * w / order, c), variation=0.3)
    assert not inside.stable
    assert inside.multipliers[0].resonance.order == order
    assert inside.multipliers[0].resonance.kind == "primary"


@pytest.mark.parametrize("ratio", [0.37, 0.9, 1.02, 2.0, 2.4])
def test_meissners_equation(ratio):
    """Two constant stiffnesses in turn: the product of two rotations."""
    c = case("psh", *SQUARE)
    w = swing(c)
    T = 2 * pi / (ratio * w)
    found = multipliers(c, speed=meshing(ratio * w, c))
    assert found.periodic.period == pytest.approx(T, rel=1e-12)
    levels = w * np.sqrt(np.array([1.0, FACTOR]) / ((1 + FACTOR) / 2))
    a = levels * T / 2
    closed = 2 * np.cos(a[0]) * np.cos(a[1]) - (levels[0] / levels[1] + levels[1] / levels[0]) * np.prod(np.sin(a))
    assert np.trace(found.matrix) == pytest.approx(closed, abs=1e-10)
    assert np.linalg.det(found.matrix) == pytest.approx(1.0, abs=1e-12)
    assert found.stable == (abs(closed) <= 2)


STAGE = ("stages.lsp.sun_planet.double_factor = 1.8", "stages.lsp.ring_planet.double_factor = 1.5")


@pytest.mark.parametrize(
    ("name", "settings"),
    [("lsp", STAGE), ("psh", SMOOTH[-2:-1]), ("psh", ('effects.mesh_stiffness = "smooth"',)), ("psh", ONE_HARMONIC)],
)
def test_liouville(name, settings):
    """The determinant is exp of the integral of A's trace, which the stiffness does not enter."""
    c = case(name, *settings)
    found = multipliers(c)
    trace = float(found.periodic.linear.matrix.trace())
    sign, log = np.linalg.slogdet(found.matrix)
    assert sign == 1
    assert log == pytest.approx(trace * found.periodic.period, rel=1e-8, abs=1e-9)


@pytest.mark.parametrize("speed", ["15 rpm", "140 rpm"])
def test_multipliers_of_an_undamped_stage_are_reciprocal_pairs(speed):
    """The stage is gyroscopic and Hamiltonian, so with mu there is 1 / mu."""
    c = case("lsp", *STAGE, *UNDAMPED, f'loads.ring.speed = "{speed}"')
    values = np.linalg.eigvals(multipliers(c).matrix)
    away = np.abs(values[:, None] * values[None, :] - 1).min(axis=1)
    assert away.max() < 1e-7


def test_a_constant_stiffness_gives_the_exponentials_of_the_eigenvalues():
    c = case("lsp", *STAGE)
    found = multipliers(c, variation=0.0)
    T, A = found.periodic.period, found.periodic.linear.scaled()
    assert find_monodromies(found.periodic, [0.0], 1)[0] == pytest.approx(expm(A * T), abs=1e-10)
    wanted = np.linalg.eigvals(A)
    wanted = wanted[wanted.imag > 0]
    first = found.multipliers[0]
    nearest = wanted[np.argmax(wanted.real)]
    assert first.growth == pytest.approx(nearest.real, rel=1e-7)
    assert first.frequency_hz == pytest.approx(abs(nearest.imag) / 2 / pi, rel=1e-7)
    assert first.resonance is None


@pytest.mark.parametrize("settings", [STAGE, (*STAGE, 'effects.mesh_stiffness = "fourier"')])
def test_multipliers_do_not_depend_on_the_phase_at_the_start(settings):
    one, two = (
        multipliers(case("lsp", *settings, *(f"stages.lsp.{mesh}.phase = {phase}" for mesh in MESHES)))
        for phase in (0.0, 0.37)
    )
    assert np.abs(one.matrix - two.matrix).max() > 1e-3
    mine, other = (np.array([[m.value.real, abs(m.value.imag)] for m in found.multipliers[:6]]) for found in (one, two))
    assert np.sort(mine, axis=0) == pytest.approx(np.sort(other, axis=0), abs=1e-6)


MESHES = ("sun_planet", "ring_planet")


def test_it_is_the_exact_solutions_monodromy():
    c = case("lsp", 'effects.lateral = "off"', *STAGE)
    exact = Exact(c.point)
    found = multipliers(c)
    assert found.periodic.period == pytest.approx(exact.period(), rel=1e-12)
    assert np.abs(np.linalg.eigvals(exact.monodromy())).max() == pytest.approx(abs(found.multipliers[0].value))


def test_the_whole_train_has_the_common_period_of_its_stages():
    c = case("rig-2mw", 'effects.lateral = "off"')
    with pytest.raises(LtcgearError) as told:
        vary(c.library, replace_teeth(c), None)
    assert "--mesh lsp" in str(told.value)


def test_the_rigs_stages_share_a_period_of_whole_pitches():
    """The least time in which every stage goes through whole pitches: their numbers have no common factor."""
    c = case("rig-2mw", 'effects.lateral = "off"')
    periodic = vary(c.library, c.p)
    hertz = {"lsp": 29.5, "hsp": 158.2272727, "psh": 628.2553476}
    assert periodic.mesh_frequencies == pytest.approx(hertz, rel=1e-9)
    assert periodic.period == pytest.approx(187 / 59 * 60 / 15, rel=1e-12)
    counts = {mesh.split(".")[0]: abs(n) for mesh, n in periodic.cycles.items()}
    assert np.gcd.reduce(list(counts.values())) == 1
    assert counts == {stage: round(periodic.period * each) for stage, each in hertz.items()}


def replace_teeth(c):
    """Tooth counts without common factors: the common period becomes very long."""
    names = [name for name, _ in c.library.manifest.parameters]
    p = c.p.copy()
    p[names.index("psh.mesh.teeth_1")] *= 997 / 59
    p[names.index("hsp.sun_planet.teeth_1")] *= 991 / 997
    return p


@pytest.mark.parametrize(
    ("settings", "mesh"),
    [((), "psh"), ((), "lsp.sun_planet"), (SMOOTH, "psh"), (FOURIER, "lsp.sun_planet"), (TABLE, "hsp.sun_planet")],
)
def test_one_mesh_varies_and_the_others_have_their_means(settings, mesh):
    """What varies lies in the rows and columns of the mesh's own gears, and has no mean."""
    c = case("rig-2mw", 'effects.lateral = "off"', *settings)
    periodic = vary(c.library, c.p, mesh)
    assert all(name.startswith(mesh) for name in periodic.meshes)
    deviation = periodic.sample(np.array([0.013, 0.41, 0.77])) - periodic.mean(512)
    names = periodic.linear.names
    stage = mesh.split(".")[0]
    inside = np.array([name.startswith(stage) or name.startswith("shaft") for name in names])
    size = np.abs(periodic.linear.scaled()).max()
    assert np.abs(deviation[:, inside]).max() > 1e-6 * size
    assert np.abs(deviation[:, ~inside]).max() < 1e-9 * size


def test_steps_are_halved_until_they_resolve_the_stiffness():
    c = case("psh", 'effects.mesh_stiffness = "smooth"', "stages.psh.mesh.transition = 0.02")
    periodic = vary(c.library, c.p)
    count, error = settle(periodic, 1.0, 1e-8)
    fine = find_monodromies(periodic, [1.0], 8 * count)[0]
    found = find_monodromies(periodic, [1.0], count)[0]
    assert error <= 1e-8
    assert np.linalg.norm(found - fine) / np.linalg.norm(fine) <= 2 * error + 1e-12
    with pytest.raises(SolverError, match="do not resolve"):
        settle(periodic, 1.0, 0.0)


# --- refused


@pytest.mark.parametrize(
    ("name", "settings", "mesh", "told"),
    [
        ("rig-2mw", TORQUE_DRIVEN, None, "speed follows from the torques.*hold it"),
        ("lin-parker-3", (), None, "stands still"),
        ("start-up", (), None, "nothing is periodic"),
        ("lsp", ('effects.mesh_stiffness = "mean"',), None, "no stiffness varies; set effects.mesh_stiffness"),
        ("lsp", (), "lsp.sun_plant", "did you mean lsp.sun_planet"),
        ("lsp", ("stages.lsp.ring_planet.double_factor = 1.0", "-stages.lsp.ring_planet.double_factor"),
         "lsp.ring_planet", "does not vary; lsp, lsp.sun_planet do"),
        ("lsp", ('loads.ring.speed = "0 rpm"',), None, "speed of 0|stands still"),
    ],
)  # fmt: skip
def test_what_is_not_periodic_is_refused(name, settings, mesh, told):
    c = case(name, *settings)
    with pytest.raises(LtcgearError, match=told):
        vary(c.library, c.p, mesh)


# --- against time simulation


def grown(c, periodic, start, periods):
    """How large the difference of two nonlinear runs is after some periods, one begun beside the other."""
    linear, size = periodic.linear, periodic.linear.scale
    shift = np.zeros(len(size))
    shift[linear.kept] = 1e-2 * start / np.abs(start / size[linear.kept]).max()
    moved = replace(c.at, x=c.at.x + shift)
    rate = 1 / periodic.period
    runs = [c.run(at=at, t_end=periods * periodic.period, rate=rate, method="erk", rtol=1e-11) for at in (c.at, moved)]
    assert all(run.status == "done" for run in runs)
    return (runs[1].x - runs[0].x)[:, linear.kept] / size[linear.kept]


LEVELS = "stages.psh.mesh.double_factor = 1.4"
TABULATED = 'stages.psh.mesh.stiffness_table = [["0", "1.6e9 N/m"], ["0.25", "1.2e9 N/m"], ["1", "1.6e9 N/m"]]'
SPUR = (
    *(f"-stages.psh.{key}" for key in ("mesh.torsional_stiffness", "mesh.reference", "mesh.double_factor")),
    'stages.psh.helix_angle = "0 deg"',
    'stages.psh.mesh.face_width = "200 mm"',
)
KINDS = {
    "two-level": (LEVELS,),
    "smooth": (LEVELS,),
    "fourier": (LEVELS, 'effects.stiffness_torque = "on"'),
    "table": (TABULATED,),
    "computed": SPUR,
}

RUBBING = (LEVELS, 'effects.mesh_friction = "sliding"', "stages.psh.mesh.friction.coefficient = 0.1")


@pytest.mark.parametrize("kind", [*KINDS, "friction"])
def test_the_matrix_is_what_a_period_of_time_simulation_does_to_small_changes(kind):
    settings = (*KINDS[kind], f'effects.mesh_stiffness = "{kind}"') if kind in KINDS else RUBBING
    c = case("psh", *settings)
    found = multipliers(c)
    periodic, scale = found.periodic, found.periodic.linear.scale
    run = {"t_end": periodic.period, "rate": 1 / periodic.period, "method": "erk", "rtol": 1e-10}
    columns = []
    for k in periodic.linear.kept:
        ends = []
        for sign in (1, -1):
            x = c.at.x.copy()
            x[k] += 0.1 * sign * scale[k]
            ends.append(c.run(at=replace(c.at, x=x), **run).x[-1])
        columns.append(((ends[0] - ends[1]) / 0.2 / scale)[periodic.linear.kept])
    simulated = np.array(columns).T
    constant = find_monodromies(periodic, [0.0], 64)[0]
    size = np.linalg.norm(simulated)
    assert np.linalg.norm(constant - simulated) > 0.04 * size
    # With friction the equilibrium is that of one instant, and teeth vibrate by a good part of their deflection.
    assert np.linalg.norm(found.matrix - simulated) < (2.5e-2 if kind == "friction" else 5e-4) * size


def test_two_runs_part_by_the_multiplier():
    """A pair on bearings in its primary tongue, teeth as involutes: the nonlinear model."""
    settings = ("stages.psh.mesh.double_factor = 1.8", "stages.psh.mesh.damping_ratio = 0.005")
    c = case("psh", *settings, f'loads.input.speed = "{-4300 * 60 / 59!r} rpm"')
    found = multipliers(c)
    first = found.multipliers[0]
    assert first.resonance.kind == "primary"
    assert first.value.imag == 0
    assert abs(first.value) > 1.1
    apart = np.linalg.norm(grown(c, found.periodic, first.shape.real, 24), axis=1)
    assert (apart[24] / apart[4]) ** (1 / 20) == pytest.approx(abs(first.value), rel=1e-2)
    # Ten times closer: the runs part at the rate of growth, not only in the multiplier's leading digit.
    assert np.log(apart[24] / apart[4]) == pytest.approx(20 * first.growth * found.periodic.period, rel=1e-2)


SPEEDS = [210, 240, 278, 281, 300, 350, 430, 458, 461, 464, 490, 520, 551, 557, 563, 600, 640, 658, 661, 690]
"""[rpm]; within the tongues 2 w11 = 2 W, 2 w17 = 2 W, 2 w11 = W and w10 + w17 = W, or between tongues."""
PERIODS, VARIATION = 120, 2.0


def test_a_planetary_stage_is_stable_where_its_chart_says_so():
    """Two nonlinear runs of the undamped stage at each of 20 speeds, the second begun beside the first."""
    c = case("lsp", *UNDAMPED)
    chart = draw_up(c.library, c.p, np.array(SPEEDS) * RPM, np.array([VARIATION]))
    mu = chart.largest[:, 0]
    assert ((mu < 1 + 1e-9) | (mu > 1.03)).all()  # none beside a border
    assert 8 <= chart.stable.sum() <= 12
    random = np.random.default_rng(5)
    for rpm, stable, wanted in zip(SPEEDS, chart.stable[:, 0], mu, strict=True):
        part = parted(c, varied(c, VARIATION, rpm * RPM), random)
        late, before = part[2 * PERIODS // 3 :].max(), part[PERIODS // 3 : 2 * PERIODS // 3].max()
        assert (late / before < 1.3) == stable, rpm
        if not stable:
            assert np.log(late / before) == pytest.approx(PERIODS / 3 * np.log(wanted), rel=0.3), rpm


def varied(c, variation, speed):
    """The parameters of the LSP at another speed, with levels a factor further from their mean."""
    number = {name: i for i, (name, _) in enumerate(c.library.manifest.parameters)}
    p = c.p.copy()
    p[number["reference.speed"]] = speed
    for mesh in MESHES:
        levels = [number[f"lsp.{mesh}.stiffness_{contact}"] for contact in ("single", "double")]
        share = p[number[f"lsp.{mesh}.single_share"]]
        mean = share * p[levels[0]] + (1 - share) * p[levels[1]]
        p[levels] = mean + variation * (p[levels] - mean)
    return p


def parted(c, p, random):
    """How far two runs are apart after each period."""
    periodic = vary(c.library, p)
    at, scale, kept = periodic.linear.at, periodic.linear.scale, periodic.linear.kept
    kick = np.zeros(len(scale))
    kick[kept] = 1e-3 * random.normal(size=len(kept)) * scale[kept]
    settings = RunSettings(PERIODS * periodic.period, 1 / periodic.period, "erk", 1e-8)
    one, two = (integrate(OperatingPoint(c.library, p, start), settings) for start in (at, replace(at, x=at.x + kick)))
    assert one.status == two.status == "done"
    return np.linalg.norm(((two.x - one.x) / scale)[:, kept], axis=1)


def test_first_order_tongues_lie_where_the_multipliers_leave_the_circle():
    """Along the border of the widest tongues the largest multiplier changes from 1 to more."""
    c = case("lsp", *UNDAMPED)
    chart = draw_up(c.library, c.p, np.linspace(440, 700, 30) * RPM, np.array([0.0, 0.25]))
    for tongue in chart.tongues[:3]:
        half = float(tongue.half_width(np.array(0.25)))
        found = [
            abs(multipliers(c, speed=tongue.speed + offset * half, variation=0.25).multipliers[0].value)
            for offset in (-1.15, -0.85, 0.0, 0.85, 1.15)
        ]
        assert (np.array(found) > 1 + 1e-6).tolist() == [False, True, True, True, False]
        # In the middle the motion grows by v sqrt(X Y).
        growth = np.log(found[2]) * tongue.base / (2 * pi)
        assert growth == pytest.approx(0.25 * tongue.coupling, rel=0.03)
        hertz = np.array(tongue.resonance.frequencies_hz).sum()
        assert hertz == pytest.approx(tongue.resonance.order * tongue.base / (2 * pi), rel=1e-12)


def test_damping_lifts_a_tongue_off_the_axis():
    """It grows from the variation sqrt(d_a d_b / X Y) on."""
    c = case("lsp", *STAGE, *(f"stages.lsp.{mesh}.damping_ratio = 0.005" for mesh in MESHES))
    chart = draw_up(c.library, c.p, np.linspace(300, 700, 20) * RPM, np.array([0.0, 1.0]))
    tongue = min(chart.tongues, key=lambda tongue: tongue.least)
    assert 0.0 < tongue.least < 1.0
    below, above = (
        multipliers(c, speed=tongue.speed, variation=factor * tongue.least).stable for factor in (0.93, 1.07)
    )
    assert below
    assert not above
    half = float(tongue.half_width(np.array(1.6 * tongue.least)))
    found = [
        multipliers(c, speed=tongue.speed + offset * half, variation=1.6 * tongue.least).stable
        for offset in (-1.2, -0.8, 0.8, 1.2)
    ]
    assert found == [True, False, False, True]
