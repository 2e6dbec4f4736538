"""The exact solution by matrix exponentials: against one written by hand, closed forms, and what it refuses."""

from dataclasses import replace

import numpy as np
import pytest
from ltcgear.generated.errors import LtcgearError
from ltcgear.runtime.simulation.matrix_exponential import Exact
from scipy.linalg import expm

from .. import exact
from ..models import TORQUE_DRIVEN, case

TORSIONAL = 'effects.lateral = "off"'


def solution(c):
    return Exact(c.point)


@pytest.mark.parametrize("speed", ["638.904 rpm", "-9000 rpm", "3 rpm"])
def test_it_is_the_one_written_by_hand(speed):
    c = case("psh", *exact.SETTINGS, f'loads.input.speed = "{speed}"')
    train = exact.Train(c.scene)
    times = np.arange(1001) / 20e3
    found, _ = solution(c).solve(times)
    wanted = train.solve(times)
    names = [*exact.FREE, *(f"{name}.rate" for name in exact.FREE)]
    size = np.maximum(np.ptp(wanted, axis=0), 1e-9)
    # The equilibria of both, from which they start, agree to 1e-10 of the deflection only.
    assert (np.abs(found[:, [c.state(name) for name in names]] - wanted).max(axis=0) / size).max() < 1e-8


@pytest.mark.parametrize("speed", ["638.904 rpm", "-9000 rpm"])
def test_its_jumps_are_those_by_hand(speed):
    c = case("psh", *exact.SETTINGS, f'loads.input.speed = "{speed}"')
    times, levels = exact.Train(c.scene).switchings(0.05)
    inside = (times > 0) & (times < 0.05)
    pieces = list(solution(c).pieces(0.05))
    assert [start for start, _, _ in pieces[1:]] == pytest.approx(times[inside], rel=1e-12)
    assert [level[0] for _, _, level in pieces] == levels[: len(pieces)].tolist()
    assert solution(c).switchings(0.05) == inside.sum()


def test_planets_in_phase_jump_at_one_instant():
    # 24 and 72 teeth are divisible by the 4 planets: all suns' meshes are in phase, and all rings'.
    settings = (TORSIONAL, "stages.lsp.sun.teeth = 24", "stages.lsp.ring.teeth = 120")
    s = solution(case("lsp", *settings))
    steps = np.array([level for _, _, level in s.pieces(0.49)])
    suns = [i for i, name in enumerate(s.library.manifest.levels) if ".sun_planet." in name]
    assert len(suns) == 4
    assert (steps[:, suns] == steps[:, suns[:1]]).all()
    assert s.switchings(0.49) == np.abs(np.diff(steps, axis=0)).sum()


def test_one_period_of_an_undamped_pair_is_hills_matrix():
    """Meissner's equation x'' + k(t) x / I = 0: the product of two rotations, whose determinant is 1."""
    settings = ('effects.damping = "off"', 'effects.mesh_damping = "off"', "stages.psh.mesh.double_factor = 1.5")
    rigid = [f'stages.psh.{part}.support = "rigid"' for part in ("input", "output")]
    without = [f"-stages.psh.{part}.bearing" for part in ("input", "output")]
    c = case("psh", TORSIONAL, *settings, *rigid, *without)
    s = solution(c)
    G = [s.generator(np.array([level]))[:-1, :-1] for level in (0.0, 1.0)]
    spin, rate = c.state("psh.output.u"), c.state("psh.output.u.rate")
    w = [np.sqrt(-g[rate, spin] * g[spin, rate]) for g in G]
    assert w[1] ** 2 / w[0] ** 2 == pytest.approx(1.5, rel=1e-12)
    T, share = s.period(), float(s.share[0])
    turn = [
        np.array([[np.cos(a), np.sin(a) / w0], [-w0 * np.sin(a), np.cos(a)]])
        for w0, a in ((w[0], w[0] * share * T), (w[1], w[1] * (1 - share) * T))
    ]
    M = s.monodromy()
    assert np.linalg.det(M) == pytest.approx(1.0, abs=1e-11)
    assert np.trace(M) == pytest.approx(np.trace(turn[1] @ turn[0]), abs=1e-10)
    assert s.growth() == pytest.approx(np.log(np.abs(np.linalg.eigvals(turn[1] @ turn[0])).max()) / T, abs=1e-9 / T)


def test_without_jumps_it_is_one_exponential():
    c = case("psh", *exact.SETTINGS, 'effects.mesh_stiffness = "mean"')
    s = solution(c)
    x, angle = c.at.x.copy(), c.state("reference.angle")
    x[c.state("generator.u")] += 1e-4
    moved = Exact(replace(c.point, at=replace(c.at, x=x)))
    times = np.array([0.0, 0.01, 0.03])
    found, _ = moved.solve(times)
    A = s.generator(np.zeros(0))[:-1, :-1] / s.scale[None, :] * s.scale[:, None]
    for time, state in zip(times, found, strict=True):
        wanted = expm(A * time) @ (x - c.at.x)
        wanted[angle] = c.scene.loads["input"].speed * time
        assert state - c.at.x == pytest.approx(wanted, abs=1e-10)
    with pytest.raises(LtcgearError, match="no period"):
        s.period()


@pytest.mark.parametrize(
    "settings",
    [
        (),
        (TORSIONAL, 'effects.contact = "backlash"'),
        (TORSIONAL, 'effects.mesh_stiffness = "smooth"'),
        (TORSIONAL, 'effects.mesh_friction = "sliding"', "stages.psh.mesh.friction.coefficient = 0.1"),
    ],
)
def test_what_is_not_linear_is_refused(settings):
    with pytest.raises(LtcgearError, match=r"not linear between jumps; set effects\.lateral=off"):
        solution(case("psh", *settings))


def test_a_speed_that_follows_from_torques_is_refused():
    with pytest.raises(LtcgearError, match="held, constant speed"):
        solution(case("rig-2mw", TORSIONAL, *TORQUE_DRIVEN))


def test_a_rig_whose_stages_share_no_short_period_says_so():
    s = solution(case("rig-2mw", TORSIONAL))
    s.rate[0] *= np.pi / 3
    with pytest.raises(LtcgearError, match="no period"):
        s.period()
