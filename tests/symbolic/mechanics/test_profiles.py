"""Quantities over the mesh phase: their values, their smoothness, and how they meet what they stand for."""

import casadi as ca
import numpy as np
import pytest
from ltcgear.symbolic.gears import gear_geometry, mesh_stiffness
from ltcgear.symbolic.mechanics.profiles import evaluate
from ltcgear.symbolic.scene.load import load_scene, make_scene

SHARE, WIDTH = 0.37, 0.2


def curve(kind, numbers, tau, level=0.0, varying=1.0):
    """Values and slopes of a profile at phases, shapes (n,)."""
    symbol = ca.SX.sym("tau")
    function = ca.Function("f", [symbol], list(evaluate(kind, symbol, level, varying, [ca.SX(n) for n in numbers])))
    return np.array([[float(v) for v in function(t)] for t in tau]).T


def test_smooth_is_two_levels_outside_its_transitions_and_has_their_mean():
    tau = np.linspace(-2, 2, 8001)[:-1]
    value, _ = curve("smooth", (3.0, 5.0, SHARE, WIDTH), tau)
    part = tau - np.floor(tau)
    flat = np.abs(np.abs(part - SHARE / 2 - np.round(part - SHARE / 2)) - SHARE / 2) > WIDTH / 2
    assert value[flat] == pytest.approx(np.where(part < SHARE, 3.0, 5.0)[flat], abs=1e-12)
    assert value.mean() == pytest.approx(3 * SHARE + 5 * (1 - SHARE), rel=1e-3)


@pytest.mark.parametrize("kind", ["smooth", "series", "tooth"])
def test_smooth_profiles_are_twice_differentiable(kind):
    """Second differences over a small step stay bounded: a kink would make them grow with one over the step."""
    numbers = {
        "smooth": (3.0, 5.0, SHARE, WIDTH),
        "series": (3.0, 0.5, 0.2, 0.1, -0.3),
        "tooth": (1.0, 2.0, 7.0, SHARE),
    }[kind]
    largest = []
    for step in (2e-3, 2e-4):
        tau = np.arange(-0.5, 4.5, step)
        value, slope = curve(kind, numbers, tau)
        assert np.gradient(value, tau)[1:-1] == pytest.approx(slope[1:-1], abs=30 * step * np.ptp(slope))
        largest.append(np.abs(np.diff(value, 3)).max() / step**3)
    # The third derivative is bounded where the second is continuous; a jump in it would give a factor of ten.
    assert largest[1] < 3 * largest[0]


def test_a_tooth_carries_its_error_alone_and_hands_it_on():
    """Errors of all teeth alike are a constant: what one hands on the next takes over."""
    tau = np.linspace(-3, 9, 1201)
    total = sum(curve("tooth", (2.5, float(j), 5.0, SHARE), tau)[0] for j in range(5))
    assert total == pytest.approx(np.full_like(tau, 2.5), abs=1e-12)
    one, _ = curve("tooth", (2.5, 2.0, 5.0, SHARE), tau)
    cycles = (tau - 2) - 5 * np.floor((tau - 2) / 5 + 0.5)
    assert one[(cycles >= 0) & (cycles <= SHARE)] == pytest.approx(2.5)
    assert one[(cycles < SHARE - 1) | (cycles > 1)] == pytest.approx(0.0, abs=1e-12)


@pytest.mark.parametrize(
    ("kind", "numbers"),
    [
        ("smooth", (3.0, 5.0, SHARE, WIDTH)),
        ("series", (3.0, 0.5, 0.2)),
        ("arcs", (SHARE, 3.0, 0.2, -1.0, 5.0, 0.1, 2.0)),
    ],
)
def test_without_variation_a_profile_is_its_mean(kind, numbers):
    tau = (np.arange(4000) + 0.5) / 4000
    level = np.where(tau < SHARE, 0.0, 1.0)
    values = np.concatenate([curve(kind, numbers, tau[level == here], here)[0] for here in (0.0, 1.0)])
    still, slope = curve(kind, numbers, tau[:5], varying=0.0)
    assert still == pytest.approx(np.full(5, values.mean()), rel=1e-4)
    assert slope == pytest.approx(np.zeros(5))


def test_the_two_level_series_is_the_fourier_integral():
    """Against a fine numerical integral of the square wave, and its sum against the wave itself."""
    phase = (np.arange(400_000) + 0.5) / 400_000
    wave = np.where(phase < SHARE, 3.0, 5.0)
    assert mesh_stiffness.two_level_series(3.0, 5.0, SHARE, 6) == pytest.approx(
        mesh_stiffness.fourier_series(phase, wave, 6), abs=1e-4
    )
    many = mesh_stiffness.two_level_series(3.0, 5.0, SHARE, 200)
    away = np.minimum(np.abs(phase - SHARE), np.minimum(phase, 1 - phase)) > 0.03
    assert np.abs(mesh_stiffness.series_values(many, phase[away][::500]) - wave[away][::500]).max() < 0.05


def test_a_table_of_a_series_gives_the_series_back():
    series = (3.0, 0.5, 0.2, 0.1, -0.3)
    phase = np.linspace(0, 1, 201)
    table = tuple(zip(phase, mesh_stiffness.series_values(series, phase), strict=True))
    assert mesh_stiffness.table_series(table, 3) == pytest.approx([*series, 0.0, 0.0], abs=2e-3)


def rig_pair(**mesh):
    """The sun mesh of the LSP as the functions of mesh_stiffness ask for it."""
    raw = load_scene("lsp").model_dump(mode="json", exclude={"name", "sources"}, exclude_none=True)
    kept = raw["stages"]["lsp"]["sun_planet"]
    for key in ("torsional_stiffness", "reference", "double_factor"):
        kept.pop(key)
    kept |= mesh
    scene = make_scene(raw)
    stage = scene.stages["lsp"]
    return stage, stage.sun_planet, stage.sun, stage.planet, 1


def test_arcs_follow_the_computed_curve():
    pair = rig_pair(face_width="400 mm")
    found = mesh_stiffness.arcs(*pair)
    from ltcgear.symbolic.gears.tooth_stiffness import Tooth
    from ltcgear.symbolic.gears.tooth_stiffness import mesh_stiffness as computed

    one, two = Tooth(22, 0.016, np.radians(20)), Tooth(48, 0.016, np.radians(20))
    phase, k = computed(one, two, 0.4, pair[0].center_distance or (22 + 48) * 0.008)
    share = gear_geometry.single_share(*pair)
    away = np.minimum(np.abs(phase - share), np.minimum(phase, 1 - phase)) > 2e-3
    for here, level in ((phase < share, 0.0), (phase >= share, 1.0)):
        value, _ = curve("arcs", (share, *found), phase[here & away], level)
        assert np.abs(value / k[here & away] - 1).max() < 5e-3


def test_the_driven_gears_curve_runs_backwards():
    pair = rig_pair(face_width="400 mm")
    forth, back = mesh_stiffness.arcs(*pair), mesh_stiffness.arcs(*pair, backwards=True)
    assert abs(forth[1]) > 1e-3 * forth[0]
    assert np.array(back) == pytest.approx(np.array(forth) * [1, -1, 1, 1, -1, 1], rel=1e-2, abs=1e-3 * forth[0])
