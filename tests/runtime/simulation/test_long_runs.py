"""Very many turns of the reference lose nothing: no digit of a phase, no switching."""

import numpy as np
import pytest
from ltcgear.runtime.model.cstruct import Native
from ltcgear.runtime.model.phase_wrapping import TURN, Clocks
from ltcgear.runtime.model.quantity_names import PHASES
from ltcgear.runtime.model.state_matrix import Equilibrium
from ltcgear.runtime.results.dataset import make_dataset
from ltcgear.runtime.results.statistics import mesh_frequencies
from ltcgear.runtime.simulation.output_reader import outputs_of, sampled

from ..models import case
from ..variants import GRAVITY

TEETH = (
    'effects.mesh_stiffness = "fourier"',
    'effects.tooth_errors = "on"',
    'stages.lsp.sun_planet.tooth_errors = [{gear = "sun", tooth = 3, error = "30 um"}, '
    '{gear = "planet", tooth = 20, error = "-25 um"}]',
    GRAVITY,
    'effects.eccentricity = "on"',
    'stages.lsp.sun.eccentricity = { radius = "20 um" }',
)
"""All of it comes round after 264 turns: 118 x 264 pitches are whole turns of the sun and of the planets."""
ROUND = 264


def shifted(c, turns):
    """The equilibrium some turns of the reference later."""
    x = c.at.x.copy()
    x[c.state("reference.angle")] = TURN * turns
    return Equilibrium(x, c.at.levels, c.at.residual, c.at.iterations)


def outputs(c, path):
    """(quantity, item) -> values over time."""
    columns = outputs_of(c.library, Clocks(c.library.manifest, c.p), path).T
    return {(r.quantity, r.item): column for r, column in zip(c.library.manifest.reports, columns, strict=True)}


@pytest.mark.parametrize("settings", [(), TEETH])
@pytest.mark.parametrize("turns", [100_056, -100_056, 264 * 10**7])
def test_far_turns_are_as_the_first(settings, turns):
    c = case("lsp", *settings)
    assert turns % ROUND == 0
    fresh, late = (c.run(at=at, method="erk", t_end=0.02, rtol=1e-7) for at in (c.at, shifted(c, turns)))
    assert late.status == fresh.status == "done"
    assert late.counts.events == fresh.counts.events == late.expected_events
    assert (late.turns == turns).all()
    for key, values in outputs(c, fresh).items():
        again = outputs(c, late)[key]
        if key[0] in PHASES:
            again = again - 118 * turns
            assert np.abs(again - values).max() <= 4e-16 * 118 * abs(turns)
        else:
            assert np.abs(again - values).max() <= 1e-12 * max(np.abs(values).max(), 1e-12)


FASTER = 'loads.carrier.speed = "-500 rpm"'
TORQUE = ('loads.input.torque = "-2.978e4 N*m"', 'loads.input.initial_speed = "-638.904 rpm"')
QUICK = {
    "lsp": ("lsp", 'loads.ring.speed = "300 rpm"'),
    "lsp, backwards": ("lsp", 'loads.ring.speed = "-300 rpm"'),
    "lsp, single teeth": ("lsp", *TEETH, 'loads.ring.speed = "300 rpm"'),
    "hsp, smooth with gravity": ("hsp", 'effects.mesh_stiffness = "smooth"', GRAVITY, FASTER),
    "psh, torque-driven": ("psh", "-loads.input.speed", *TORQUE),
}


@pytest.mark.parametrize("name", QUICK)
def test_what_is_taken_off_on_the_way_changes_nothing(name, monkeypatch):
    """Against the same run with an angle that grows on."""
    c = case(*QUICK[name])
    path = c.run(method="erk", rtol=1e-9, t_end=0.5, rate=1024.0)
    assert path.status == "done"
    assert len(np.unique(path.turns)) > 1
    assert path.counts.events == (path.expected_events or 0)
    with monkeypatch.context() as patch:
        patch.setattr(Clocks, "turns_in", lambda self, phi: 0)
        plain = c.run(method="erk", rtol=1e-9, t_end=0.5, rate=1024.0)
    assert (plain.turns == 0).all()
    assert plain.counts.events == path.counts.events
    assert (plain.levels == path.levels).all()
    assert path.extremes.lowest == pytest.approx(plain.extremes.lowest, rel=2e-5)  # steps lie elsewhere
    assert path.energy == pytest.approx(plain.energy, rel=1e-9)
    one, two, reports = (
        outputs_of(c.library, Clocks(c.library.manifest, c.p), plain),
        outputs_of(c.library, Clocks(c.library.manifest, c.p), path),
        c.library.manifest.reports,
    )
    for column, report in enumerate(reports):
        alike = [i for i, other in enumerate(reports) if other.unit == report.unit]
        assert np.abs(one - two)[:, column].max() <= 1e-7 * np.abs(one[:, alike]).max(), report


def test_reported_phases_and_angles_go_on_over_the_turns():
    c = case(*QUICK["lsp"])
    path = c.run(method="erk", rtol=1e-7, t_end=0.7, rate=1000.0)
    data = make_dataset(c.library, c.p, sampled(c.library, path, c.p))
    assert mesh_frequencies(data, 0.0)["lsp"] == pytest.approx(300 / 60 * 118, rel=1e-4)
    for name, spread in (("mesh_phase", 1e-11), ("gear_phase", 0.1)):
        steps = np.diff(data[name].values, axis=0)
        assert steps == pytest.approx(300 / 60 * 118 / 1000, rel=spread), name
    angle = data["state"].sel(state_name="reference.angle").values
    assert np.abs(angle - 300 / 60 * TURN * data["time"].values).max() < 1e-12 * angle.max()


def test_a_held_speed_sets_the_angle_whatever_the_tolerance():
    c = case(*QUICK["lsp"])
    path = c.run(method="cvodes", rtol=1e-3, t_end=0.5)
    speed = 300 / 60 * TURN
    assert np.abs(path.phi + TURN * path.turns - speed * path.time).max() < 1e-12 * speed


def test_late_times_add_up():
    native = Native()
    state, passes = native.state, native.engine.ltcgear_pass
    state.time, state.unpassed = 1e6, 0.0
    for _ in range(10_000):
        passes(state, 1.1e-5, np.inf)
    assert state.time + state.unpassed - 1e6 == pytest.approx(0.11, abs=2e-10)
    passes(state, 2e6 - state.time, 2e6)
    assert (state.time, state.unpassed) == (2e6, 0.0)
