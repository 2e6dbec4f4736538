"""Phases of meshes: the one by which the stiffness varies, and the one of gear 1's own motion."""

import numpy as np
import pytest
from ltcgear.runtime.analysis.trace import phase_of
from ltcgear.runtime.model.members import train_of
from ltcgear.runtime.model.phase_wrapping import TURN, Clocks
from ltcgear.runtime.model.quantity_names import PHASES
from ltcgear.runtime.results.dataset import make_dataset
from ltcgear.runtime.simulation.output_reader import outputs_of, sampled

from reference.hand_profiles import smooth_levels

from ..models import TORQUE_DRIVEN, case, run
from ..variants import BACKLASH, SMOOTH, TORQUE

RIG = ("rig-2mw",)
DRIVEN = ("rig-2mw", *TORQUE_DRIVEN[:1], 'loads.motor.torque = "6e6 N*m"', 'loads.motor.initial_speed = "12 rpm"')
SWITCHED = {"lsp.sun_planet", "lsp.ring_planet", "hsp.sun_planet", "psh.mesh"}
"""Of the rig; the HSP's ring meshes have a constant stiffness."""


def outputs(scene, **options):
    """The case, its run, and (quantity, item) -> values over time."""
    options = {"method": "erk", "rtol": 1e-6, "t_end": 0.2, "rate": 65536.0} | options
    c, path = case(*scene), run(*scene, **options)
    columns = outputs_of(c.library, Clocks(c.library.manifest, c.p), path).T
    return (
        c,
        path,
        {(r.quantity, r.item): column for r, column in zip(c.library.manifest.reports, columns, strict=True)},
    )


def group_of(c, mesh):
    """The group of a mesh, with which the names of its parameters begin."""
    return train_of(c.library.manifest).group(mesh)


def crossings(phase, share):
    """Samples before which a phase that rises passes a border, and the fractions there: 0 and the share."""
    found = [np.flatnonzero(np.diff(np.floor(phase - at + 1e-9))) for at in (0.0, share)]
    at = np.repeat((0.0, share), [len(one) for one in found])
    order = np.argsort(np.concatenate(found))
    return np.concatenate(found)[order], at[order]


@pytest.mark.parametrize("scene", [RIG, DRIVEN])
def test_a_level_changes_where_the_phase_that_is_told_passes_its_borders(scene):
    c, path, told = outputs(scene)
    values, counted = c.model.values(), dict.fromkeys(SWITCHED, 0)
    for i, mesh in enumerate(c.library.manifest.levels):
        where, at = crossings(told["mesh_phase", mesh], values[f"{group_of(c, mesh)}.single_share"])
        change = np.diff(path.levels[:, i])
        assert where.tolist() == np.flatnonzero(change).tolist(), mesh
        assert (change[where] == np.where(at > 0, 1, -1)).all()
        counted[group_of(c, mesh)] += len(where)
    assert counted.keys() == SWITCHED
    assert min(counted.values()) >= 30


def test_forces_folded_over_the_phase_jump_at_its_borders():
    """A force jumps with its own stiffness only; what it bends besides is far less, and is taken off its steps."""
    c, _, told = outputs(RIG)
    values = c.model.values()
    for mesh in c.library.manifest.levels:
        steps = np.diff(told["mesh_force", mesh])
        bends = np.abs(steps[1:-1] - (steps[:-2] + steps[2:]) / 2)
        where, at = crossings(told["mesh_phase", mesh][1:-1], values[f"{group_of(c, mesh)}.single_share"])
        assert len(set(at)) == 2
        beside = np.concatenate([where - 1, where, where + 1])
        assert bends[where].min() > 20 * np.delete(bends, beside[(beside >= 0) & (beside < len(bends))]).max(), mesh


def gear_turned(c, told, mesh):
    """Angle [rad] by which gear 1 has turned against the rigid motion, seen from the line of centres as it lies."""
    values = c.model.values()
    phase = next(item for item in c.model.phases if item.name == mesh)
    one, two = next(i.bodies for i in c.model.instances if (i.name, i.group) == (mesh, "mesh"))
    (x1, y1), (x2, y2) = (
        np.array(c.model.nominal_place(body))[:, None]
        + [told.get((f"displacement_{axis}", body), np.zeros(1)) for axis in "xy"]
        for body in (one, two)
    )
    assert phase.gear == one
    e_x, e_y = values[f"{mesh}.e_x"], values[f"{mesh}.e_y"]
    dx, dy = x2 - x1, y2 - y1
    return told.get(("twist", one), 0.0) - np.arctan2(e_x * dy - e_y * dx, e_x * dx + e_y * dy)


def test_the_gears_own_phase_is_ahead_by_what_shafts_wind_up():
    c, _, told = outputs(RIG)
    values, ahead = c.model.values(), {}
    for mesh in (item.name for item in c.model.phases):
        ahead[mesh] = told["gear_phase", mesh] - told["mesh_phase", mesh]
        teeth = values[f"{group_of(c, mesh)}.teeth_1"]
        assert ahead[mesh] == pytest.approx(teeth / TURN * gear_turned(c, told, mesh), abs=1e-9), mesh
    assert len(ahead) == 15
    assert ahead["hsp.sun_planet.1"].mean() == pytest.approx(-2.7, abs=0.1)  # three teeth nearly


@pytest.mark.parametrize("torque", [(), (TORQUE,)])
def test_a_smooth_stiffness_varies_by_the_phase_that_is_told(torque):
    c, _, told = outputs(("psh", *SMOOTH[:1], *torque, 'effects.mesh_damping = "off"'), t_end=0.02, rate=32768.0)
    number = {name.removeprefix("psh.mesh."): value for name, value in c.model.values().items()}
    shape = (number["stiffness_single"], number["stiffness_double"], number["single_share"], number["transition"])
    phase, own = told["mesh_phase", "psh.mesh"], told["gear_phase", "psh.mesh"]
    stiffness = told["mesh_force", "psh.mesh"] / told["mesh_deflection", "psh.mesh"]
    assert stiffness == pytest.approx([float(smooth_levels(tau, *shape)[0]) for tau in phase], rel=1e-9)
    assert (np.abs(own - phase).max() == 0) == bool(torque)


def test_both_flanks_of_a_mesh_share_its_phases():
    c = case("psh", *BACKLASH[:1], 'stages.psh.mesh.backlash = "15 um"')
    path = c.run(method="erk", t_end=0.01, rate=1000.0)
    data = make_dataset(c.library, c.p, sampled(c.library, path, c.p))
    assert data["mesh_force"].sizes["mesh"] == 2
    for name in PHASES:
        assert data[name].shape == (11, 1)
        assert data[name].attrs["units"] == "1"
    assert phase_of(data, "psh.mesh.back").values == pytest.approx(59 * 638.904 / 60 * data["time"].values, abs=1e-9)


def test_a_mesh_of_constant_stiffness_has_phases_too():
    c, path, told = outputs(("psh", 'effects.mesh_stiffness = "mean"'), t_end=0.02)
    assert c.library.manifest.levels == ()
    assert told["mesh_phase", "psh.mesh"] == pytest.approx(59 * 638.904 / 60 * path.time, abs=1e-9)
    assert np.ptp(told["gear_phase", "psh.mesh"] - told["mesh_phase", "psh.mesh"]) < 1e-3
