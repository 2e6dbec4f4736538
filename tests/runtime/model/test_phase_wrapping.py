"""Whole turns taken off the reference angle: nothing that is computed sees it."""

from fractions import Fraction
from math import floor, lcm

import numpy as np
import pytest
from ltcgear.runtime.model.phase_wrapping import TURN, Clocks, rational
from ltcgear.runtime.model.quantity_names import PHASES
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.emit.c_text import emit, functions
from ltcgear.symbolic.mechanics.equations import derive
from ltcgear.symbolic.scene.load import make_scene

from ..models import case, raw_scene
from ..variants import GRAVITY, TORSIONAL, VARIANTS

TURNS = 3
TOLERANCE = 1e-9
UNEVEN = (
    'effects.planet_position_error = "on"',
    'stages.hsp.position_errors = [{planet = 2, radial = "60 um"}]',
)
MIXED = (
    "all at once",
    "eccentricity, smooth with torque",
    "tooth errors",
    "rigid pins out of place, held carrier, gravity",
    "floating carrier, all of it",
    "torsional, all of it",
    "torque-driven on rigid pins",
)


@pytest.mark.parametrize("name", MIXED)
def test_functions_do_not_see_turns_that_were_taken_off(name):
    model = build_model(make_scene(raw_scene("rig-2mw", *VARIANTS[name])))
    equations = derive(model)
    manifest, made = emit(model, equations).manifest, functions(equations)
    p = np.array(list(model.values().values()))
    clocks = Clocks(manifest, p)
    rng = np.random.default_rng(4)
    x, s = rng.uniform(-1e-4, 1e-4, len(manifest.states)), rng.uniform(0, 1, made["rhs"].size1_in(1))
    for state, row in zip(manifest.states, range(len(x)), strict=True):
        if state.name == "reference.speed":
            x[row] = 1.5
    x[clocks.angle] = 2.0
    far = x.copy()
    far[clocks.angle] += TURN * TURNS
    for kind in ("rhs", "outputs", "energy"):
        one, two = (np.array(made[kind](*given)).ravel() for given in ((far, s, p), (x, s, clocks.parameters(TURNS))))
        if kind == "outputs":
            phases = [i for i, report in enumerate(manifest.reports) if report.quantity in PHASES]
            assert len(phases) == 2 * 15
            two[phases] += clocks.unwound([manifest.reports[i].item for i in phases], np.array([TURNS]))[0]
            one, two = (scaled(values, manifest) for values in (one, two))
        assert np.isfinite(one).all()
        assert np.abs(one - two).max() <= TOLERANCE * np.abs(one).max()


def scaled(values, manifest):
    """Outputs over the largest of their quantity."""
    found = np.empty_like(values)
    for quantity in {report.quantity for report in manifest.reports}:
        rows = [i for i, report in enumerate(manifest.reports) if report.quantity == quantity]
        found[rows] = values[rows] / max(np.abs(values[rows]).max(), 1e-12)
    return found


@pytest.mark.parametrize("turns", [-100_003, -1, 1, 12_345, 10**9])
def test_phases_after_many_turns_are_those_of_whole_numbers(turns):
    """By tooth counts alone: the HSP carrier turns with the LSP sun, the PSH pinion's wheel with the HSP sun."""
    c = case("rig-2mw")
    clocks, names = Clocks(c.library.manifest, c.p), [name for name, _ in c.library.manifest.parameters]
    stages, later = c.scene.stages, clocks.parameters(turns)
    lsp = Fraction(-stages["lsp"].ring.teeth, stages["lsp"].sun.teeth)
    hsp = lsp * (1 + Fraction(stages["hsp"].ring.teeth, stages["hsp"].sun.teeth))
    wanted = {
        "lsp.sun_planet.1": abs(lsp) * stages["lsp"].sun.teeth,
        "hsp.sun_planet.2": abs(hsp - lsp) * stages["hsp"].sun.teeth,
        "hsp.ring_planet.1": abs(lsp) * stages["hsp"].ring.teeth,
        "psh.mesh": abs(hsp) * stages["psh"].input.teeth,
    }
    for mesh, advance in wanted.items():
        i = names.index(f"{mesh}.phase")
        assert later[i] - c.p[i] == pytest.approx(float(advance * turns % 1), abs=1e-14 * (1 + abs(c.p[i])))
        assert clocks.cycles([mesh], turns)[0] == floor(advance * turns)
    i = names.index("hsp.frame.start_angle")
    assert later[i] == pytest.approx(TURN * float(lsp * turns % 1), abs=1e-15)


def test_a_tooth_out_of_place_comes_round_with_its_gear():
    model = build_model(make_scene(raw_scene("rig-2mw", *VARIANTS["tooth errors"])))
    periods = {clock.mesh: clock.periods for clock in model.clocks}
    values = model.values()
    teeth = {mesh: sorted(values[name] for name in names) for mesh, names in periods.items()}
    assert teeth["psh.mesh"] == sorted([59] + [21] * 7)
    assert teeth["lsp.sun_planet.1"] == [22, 48]
    assert teeth["lsp.sun_planet.3"] == [22, 48, 48]
    assert teeth["lsp.ring_planet.1"] == []
    case_ = case("rig-2mw", *VARIANTS["tooth errors"])
    clocks = Clocks(case_.library.manifest, case_.p)
    gone = clocks.cycles(["psh.mesh", "lsp.sun_planet.1", "lsp.ring_planet.1"], 1_001)
    assert gone[0] % lcm(59, 21) == 0
    assert gone[1] % lcm(22, 48) == 0
    assert gone[2] == 118 * 1_001


@pytest.mark.parametrize("value", [Fraction(-118, 22), Fraction(1), Fraction(0), Fraction(7_433, 99_991)])
def test_ratios_of_whole_numbers_are_found(value):
    for rounded in (float(value), float(value) * (1 + 2e-16)):
        assert rational(rounded) == value


def test_a_number_that_is_no_such_ratio_stays_as_it_is():
    assert rational(np.pi) == Fraction(np.pi)


def test_what_does_not_turn_has_no_clock():
    assert case("lin-parker-3").library.manifest.clocks == ()
    names = [name for name, _ in case("lsp").library.manifest.parameters]
    assert not [name for name in names if name.endswith("start_angle")]


def test_only_a_frame_whose_angle_is_seen_has_a_start():
    def starts(*settings):
        names = build_model(make_scene(raw_scene("hsp", *settings))).values()
        return [name for name in names if name.endswith("start_angle")]

    assert starts() == ["hsp.frame.start_angle"]
    assert starts(TORSIONAL) == []
    assert starts(TORSIONAL, GRAVITY) == []
    assert starts(TORSIONAL, GRAVITY, *UNEVEN) == ["hsp.frame.start_angle"]
