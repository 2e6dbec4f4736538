"""Mesh levels: cells and their borders, and integrations against counts and levels known from kinematics."""

import numpy as np
import pytest
from ltcgear.runtime.model.contact_levels import AT_BORDER, Phases, cells_of, levels_of, lower, upper
from ltcgear.runtime.model.state_matrix import Equilibrium

from ..engine import crossed, time_to_border
from ..hand_gearing import contact_ratio
from ..models import TORQUE_DRIVEN, case, run

RPM = 2 * np.pi / 60


def phases(tau, rate=1.0, share=0.4):
    tau = np.atleast_1d(np.asarray(tau, float))
    return Phases(tau, np.broadcast_to(np.asarray(rate, float), tau.shape), np.broadcast_to(share, tau.shape))


def walk(start, rate, share, duration):
    """Go from border to border for a time; return cells on the way and the time left over each step."""
    now = phases(start, rate, share)
    cells, path, clock = cells_of(now), [], 0.0
    path.append(cells)
    while True:
        step = time_to_border(cells, now)
        if clock + step > duration:
            return path
        clock += step
        before, now = now, phases(now.tau + now.rate * step, rate, share)
        cells, part = crossed(cells, before, now)
        assert part == 1.0
        path.append(cells)


# --- cells


@pytest.mark.parametrize(
    ("tau", "cell", "level"),
    [(0.1, 0, 0), (0.39, 0, 0), (0.41, 1, 1), (0.99, 1, 1), (1.1, 2, 0), (7.5, 15, 1), (-0.1, -1, 1), (-0.9, -2, 0)],
)
def test_single_contact_comes_first_in_a_pitch(tau, cell, level):
    cells = cells_of(phases(tau))
    assert cells == cell
    assert levels_of(cells) == level


@pytest.mark.parametrize("rate", [1.0, 0.0])
@pytest.mark.parametrize(("border", "cell"), [(0.0, 0), (0.4, 1), (1.0, 2), (1.4, 3), (-0.6, -1), (-1.0, -2)])
def test_on_a_border_the_cell_ahead_counts(border, cell, rate):
    for offset in (0.0, 0.9 * AT_BORDER, -0.9 * AT_BORDER):
        assert cells_of(phases(border + offset, rate)) == cell


@pytest.mark.parametrize(("border", "cell"), [(0.0, -1), (0.4, 0), (1.0, 1), (1.4, 2), (-0.6, -2), (-1.0, -3)])
def test_on_a_border_backwards_the_cell_below_counts(border, cell):
    for offset in (0.0, 0.9 * AT_BORDER, -0.9 * AT_BORDER):
        assert cells_of(phases(border + offset, -1.0)) == cell


def test_borders_enclose_their_cell():
    cells = np.arange(-6, 7)
    share = np.full(13, 0.4)
    assert (upper(cells, share) == lower(cells + 1, share)).all()
    middle = (upper(cells, share) + lower(cells, share)) / 2
    assert (cells_of(phases(middle)) == cells).all()
    assert np.allclose(lower(cells, share)[6:9], [0.0, 0.4, 1.0], atol=0)


def test_time_to_the_nearest_border_of_all():
    assert time_to_border(np.array([0, 1]), phases([0.1, 0.5], [2.0, 10.0])) == pytest.approx(0.05)
    assert time_to_border(np.array([0, 1]), phases([0.1, 0.5], [-2.0, 0.0])) == pytest.approx(0.05)
    assert time_to_border(np.array([0, 1]), phases([0.1, 0.5], 0.0)) == float("inf")
    assert time_to_border(np.zeros(0, int), phases([])) == float("inf")
    assert time_to_border(np.array([0]), phases(0.4 + 1e-12)) == 0.0


def test_only_phases_at_a_border_switch():
    now = phases([0.4, 0.3, 0.4], [1.0, 1.0, -1.0])
    cells, part = crossed(np.array([0, 0, 1]), now, now)
    assert cells.tolist() == [1, 0, 0]
    assert part == 1.0


def test_a_phase_that_is_past_its_border_says_where_in_the_step():
    assert crossed(np.array([0]), phases(0.25), phases(0.45))[1] == pytest.approx(0.75)
    assert crossed(np.array([1]), phases(0.45, -1.0), phases(0.35, -1.0))[1] == pytest.approx(0.5)


def test_the_first_of_several_borders_decides():
    before, after = phases([0.3, 0.0], [1.0, 4.0]), phases([0.5, 0.8], [1.0, 4.0])
    cells, part = crossed(np.array([0, 0]), before, after)
    assert part == pytest.approx(0.5)
    assert cells.tolist() == [0, 0]  # nothing switches before the border is met


@pytest.mark.parametrize("rate", [1.0, -1.0])
@pytest.mark.parametrize("share", [0.4, 0.5, 0.01, 0.99])
@pytest.mark.parametrize("start", [0.0, 0.123, "share", -3.0])
def test_every_cell_is_entered_once(start, share, rate):
    start = share if start == "share" else start
    cells = np.ravel(walk(start, rate, share, 25.0))
    assert (np.diff(cells) == np.sign(rate)).all()
    # 25 pitches hold 50 borders; the start's own does not count, the end's does where the walk ends on it
    assert 49 <= len(cells) - 1 <= 50


@pytest.mark.parametrize("rate", [3.7, -3.7])
def test_planets_in_phase_switch_together(rate):
    start = np.array([0.2, 1.2, -4.8, 0.2 + 3e-16])
    path = np.array(walk(start, rate, 0.37, 10.0))
    assert (np.diff(path, axis=0) == np.sign(rate)).all()
    assert len(path) - 1 == 74


def test_planets_half_a_pitch_apart_with_share_one_half_switch_together_too():
    path = np.array(walk([0.0, 0.5], 1.0, 0.5, 10.25))
    assert (np.diff(path, axis=0) == 1).all()
    assert (levels_of(path).sum(axis=1) == 1).all()
    assert len(path) - 1 == 20


def test_meshes_out_of_phase_switch_one_by_one():
    path = np.array(walk([0.0, 0.25, 0.5, 0.75], 1.0, 0.4, 1.0))
    assert (np.abs(np.diff(path, axis=0)).sum(axis=1) == 1).all()
    assert len(path) - 1 in (7, 8)


def test_turning_back_on_a_border_returns_to_the_cell_left():
    cells, _ = crossed(np.array([0]), phases(0.3, 1.0), phases(0.4, 1.0))
    back, _ = crossed(cells, phases(0.4, -1.0), phases(0.4, -1.0))
    assert (cells, back) == (1, 0)


@pytest.mark.parametrize("rate", [29.5, -29.5])
@pytest.mark.parametrize("turns", [1e3, 1e5])
def test_many_turns_lose_no_switching(turns, rate):
    start = 118 * turns + 0.123
    cells = np.ravel(walk(start, rate, 0.3359, 10.0))
    assert (np.diff(cells) == np.sign(rate)).all()
    assert len(cells) - 1 == 590


# --- integrations


def nominal_phase(c, mesh, t, speed):
    """Phase [cycles] of a mesh of a rig's stage by hand: eqs 9-11, the planets' parts Z (i-1)/n.

    ``speed`` is that of the stage's driving member [rad/s]: the LSP ring, or in the rig too.
    """
    stage, label = mesh.split(".")[:2]
    z = {"lsp": (22, 48, 118), "hsp": (17, 50, 118)}
    ring = speed
    sun = -118 / 22 * ring
    if stage == "lsp":
        wheel, w, carrier, n = (22, sun, 0.0, 4) if label == "sun_planet" else (118, ring, 0.0, 4)
    elif stage == "hsp":
        carrier, n = sun, 3
        wheel, w = (17, (1 + 118 / 17) * carrier) if label == "sun_planet" else (z["hsp"][2], 0.0)
    else:
        wheel, w, carrier, n = 59, (1 + 118 / 17) * sun, 0.0, 1
    i = int(mesh.split(".")[2]) if stage != "psh" else 1
    rate = wheel * (w - carrier) / (2 * np.pi)
    return abs(rate) * t - np.sign(rate) * wheel * (i - 1) / n  # it counts up in the sense of rotation


def share_of(c, mesh):
    """Share of single contact, 2 - contact ratio."""
    stage, label = c.scene.stages[mesh.split(".")[0]], mesh.split(".")[1]
    if label == "mesh":
        pair = (stage.input, stage.output)
        distance = 0.36 / np.cos(np.deg2rad(8))
    else:
        pair = (getattr(stage, label.split("_")[0]), stage.planet)
        distance = stage.center_distance or 0.56
    return 2 - contact_ratio(stage, -1 if label == "ring_planet" else 1, *pair, distance)


def border_count(tau0, tau1, share):
    """Borders at whole numbers and at whole numbers + share, passed from tau0 (which does not count) to tau1."""
    low, high = sorted((tau0, tau1))
    tiny = 1e-9 if tau1 > tau0 else -1e-9
    return sum(int(np.floor(high - b + tiny) - np.floor(low - b + tiny)) for b in (0.0, share))


SPEED = 15 * RPM
REVERSED = {
    "rig-2mw": ('loads.motor.speed = "-15 rpm"',),
    "lsp": ('loads.ring.speed = "-15 rpm"',),
}


@pytest.mark.parametrize("way", [1, -1])
@pytest.mark.parametrize("scene", ["lsp", "rig-2mw"])
def test_events_are_those_of_kinematics(scene, way):
    settings = REVERSED[scene] if way < 0 else ()
    c, path = case(scene, *settings), run(scene, *settings, method="erk", rtol=1e-5, t_end=0.5)
    wanted = 0
    for mesh in c.library.manifest.levels:
        tau = [nominal_phase(c, mesh, t, way * SPEED) for t in (0.0, 0.5)]
        wanted += border_count(*tau, share_of(c, mesh))
    assert path.status == "done"
    assert wanted > 100
    assert path.counts.events == path.expected_events == wanted


@pytest.mark.parametrize("way", [1, -1])
@pytest.mark.parametrize("scene", ["lsp", "rig-2mw"])
def test_levels_at_samples_are_those_of_the_phases(scene, way):
    settings = REVERSED[scene] if way < 0 else ()
    c, path = case(scene, *settings), run(scene, *settings, method="erk", rtol=1e-5, t_end=0.5)
    for i, mesh in enumerate(c.library.manifest.levels):
        share = share_of(c, mesh)
        part = np.mod(nominal_phase(c, mesh, path.time, way * SPEED), 1.0)
        from_border = np.min([np.abs(part - b) for b in (0.0, share, 1.0)], axis=0)
        clear = from_border > 1e-7
        assert clear.sum() > 0.99 * len(clear)
        assert (path.levels[clear, i] == (part[clear] >= share)).all()


@pytest.mark.parametrize("method", ["erk", "cvodes"])
def test_switchings_of_an_accelerating_train_are_those_of_its_angle(method):
    settings = (*TORQUE_DRIVEN[:1], 'loads.motor.torque = "6e6 N*m"', 'loads.motor.initial_speed = "2 rpm"')
    c, path = case("rig-2mw", *settings), run("rig-2mw", *settings, method=method, rtol=1e-6, t_end=0.4)
    angle = path.x[:, c.state("reference.angle")]
    assert path.status == "done"
    assert path.x[-1, c.state("reference.speed")] > 2 * path.x[0, c.state("reference.speed")]
    wanted = 0
    for i, mesh in enumerate(c.library.manifest.levels):
        share, tau = share_of(c, mesh), nominal_phase(c, mesh, angle, 1.0)
        wanted += border_count(tau[0], tau[-1], share)
        part = np.mod(tau, 1.0)
        clear = np.min([np.abs(part - b) for b in (0.0, share, 1.0)], axis=0) > 1e-6
        assert (path.levels[clear, i] == (part[clear] >= share)).all()
    assert path.counts.events == path.expected_events == wanted > 100


@pytest.mark.parametrize("method", ["erk", "cvodes", "sundae"])
@pytest.mark.parametrize(("torque", "speed"), [("-6e6", "2"), ("-9e6", "0.5")])
def test_a_train_that_its_loads_turn_back_loses_no_switching(torque, speed, method):
    settings = (
        "-loads.motor.speed",
        f'loads.motor.torque = "{torque} N*m"',
        f'loads.motor.initial_speed = "{speed} rpm"',
    )
    c, path = case("rig-2mw", *settings), run("rig-2mw", *settings, method=method, rtol=1e-6, t_end=0.2, rate=65536.0)
    turning, angle = path.x[:, c.state("reference.speed")], path.x[:, c.state("reference.angle")]
    assert path.status == "done"
    assert turning.min() < 0
    back = int(np.argmax(angle))
    wanted = 0
    for mesh in c.library.manifest.levels:
        tau, share = nominal_phase(c, mesh, angle, 1.0), share_of(c, mesh)
        wanted += border_count(tau[0], tau[back], share) + border_count(tau[back], tau[-1], share)
    assert path.counts.events == path.expected_events == wanted > 5


def test_reversal_mirrors_the_count():
    counts = [run("rig-2mw", *s, method="erk", rtol=1e-5, t_end=0.5).counts.events for s in ((), REVERSED["rig-2mw"])]
    assert abs(counts[0] - counts[1]) <= len(case("rig-2mw").library.manifest.levels)


def test_a_contact_ratio_that_makes_half_shares():
    c = case("psh", "stages.psh.mesh.contact_ratio = 1.5")
    path = c.run(method="erk", rtol=1e-5, t_end=0.1)
    cycles = 59 * 638.904 / 60 * 0.1
    assert path.counts.events == int(np.floor(2 * cycles))


def test_a_switching_on_a_sample_belongs_to_what_follows():
    # 60 teeth at 60 rpm: 60 pitches a second; with share 1/2 a border on every 120th of a second.
    settings = (
        "stages.psh.input.teeth = 60",
        'loads.input.speed = "60 rpm"',
        "stages.psh.mesh.contact_ratio = 1.5",
    )
    c = case("psh", *settings)
    path = c.run(method="erk", rtol=1e-5, t_end=0.5, rate=120.0)
    assert path.counts.events == path.expected_events
    assert abs(path.counts.events - 60) <= 1
    assert len(path.time) == 61
    assert (np.diff(path.time) > 0).all()


def shifted(c, turns):
    """The equilibrium some turns of the reference later."""
    x = c.at.x.copy()
    x[c.state("reference.angle")] = 2 * np.pi * turns
    return Equilibrium(x, c.at.levels, c.at.residual, c.at.iterations)


@pytest.mark.parametrize("turns", [1e3, 1e5])
@pytest.mark.parametrize("method", ["cvodes", "erk"])
def test_after_many_turns_the_forces_are_those_of_the_first(turns, method):
    c = case("lsp")
    fresh, late = (c.run(at=at, method=method, rtol=1e-7, t_end=0.1) for at in (c.at, shifted(c, turns)))
    assert late.status == "done"
    assert late.counts.events == fresh.counts.events == late.expected_events
    assert (fresh.levels == late.levels).all()
    one, two = c.mesh_forces(fresh), c.mesh_forces(late)
    assert np.abs(one - two).max() < 1e-12 * np.abs(one).mean()
