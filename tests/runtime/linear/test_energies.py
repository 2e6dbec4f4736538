"""Strain energy of modes against matrices by hand, against kinetic energy, and what modes are called."""

import numpy as np
import pytest
from ltcgear.runtime.linear.energies import Energies
from ltcgear.runtime.linear.modes import find_modes
from ltcgear.runtime.linear.naming import describe_modes, sum_by
from ltcgear.runtime.linear.system import linearise
from ltcgear.runtime.model.topology import Topology

from reference import lin_parker

from ..models import case


def described(name, *settings):
    c = case(name, *settings)
    linear = linearise(c.point)
    return linear, describe_modes(linear, find_modes(linear))


PARTS = {
    "gear.pin": ("K_PIN", None),
    "gear.sun_planet": ("K_MESH", "sun"),
    "gear.ring_planet": ("K_MESH", "ring"),
    **{f"gear.{body}.bearing": ("K_LATERAL", body) for body in lin_parker.CENTRAL},
    "gear.ring.torsional_support": ("K_TORSION", "ring"),
}


@pytest.mark.parametrize("n", [3, 4, 5])
def test_strain_shares_are_those_of_the_matrices_by_hand(n, monkeypatch):
    """Sums over repeated modes, whose own shapes are free."""
    M, K = lin_parker.matrices(n)
    parts = {}
    for element, (name, body) in PARTS.items():
        with monkeypatch.context() as patch:
            patch.setattr(lin_parker, name, 0.0 if body is None else getattr(lin_parker, name) | {body: 0.0})
            parts[element] = K - lin_parker.matrices(n)[1]
    root = np.sqrt(np.diag(M))
    squares, shapes = np.linalg.eigh(K / np.outer(root, root))
    shapes = shapes / root[:, None]
    linear, modes = described(f"lin-parker-{n}")
    groups = Topology(linear.library.manifest).groups
    assert modes[0].strain == {}
    for group in {mode.group for mode in modes[1:]}:
        places = [k for k, mode in enumerate(modes) if mode.group == group]
        found = [sum_by(modes[k].strain, groups) for k in places]
        for element, part in parts.items():
            wanted = sum(shapes[:, k] @ part @ shapes[:, k] / squares[k] for k in places)
            assert sum(one.get(element, 0.0) for one in found) == pytest.approx(wanted, abs=2e-6)


@pytest.mark.parametrize("name", ["lin-parker-4", "hard-friction", "rig-2mw"])
def test_shares_of_strain_and_kinetic_energy(name):
    _, modes = described(name)
    for mode in modes:
        if mode.kind != "rigid":
            assert sum(mode.strain.values()) == pytest.approx(1.0)
            assert sum(mode.members.values()) == pytest.approx(1.0)
            # Meshes that are pressed give back a little as they tilt; without load nothing does.
            assert min(mode.strain.values()) > (-0.01 if name == "rig-2mw" else -1e-12)


def test_strain_energy_is_kinetic_energy_without_damping_and_rotation():
    linear, modes = described("lin-parker-4")
    energies = Energies(linear)
    for mode in modes[1:]:
        rate = mode.shape[linear.rates]
        kinetic = (rate.conj() @ linear.mass @ rate).real / 2
        assert sum(energies.of_shape(mode.shape).values()) == pytest.approx(kinetic, rel=1e-9)


@pytest.mark.parametrize("settings", [(), ("effects.gravity = 'on'",), ("effects.contact = 'backlash'",)])
def test_strain_energy_is_the_work_of_the_linear_forces_of_a_loaded_train(settings):
    """What the springs' part of -M A does, by A itself: rotation slow, no weight's potential, rotor held."""
    c = case("rig-2mw", 'loads.motor.speed = "1e-6 rpm"', *settings)
    linear = linearise(c.point)
    energies, rng = Energies(linear), np.random.default_rng(1)
    for _ in range(3):
        u = linear.scale[linear.kept[linear.positions]] * rng.standard_normal(len(linear.positions))
        z = np.zeros(len(linear.kept))
        z[linear.positions] = u
        work = -u @ linear.mass @ (linear.matrix @ z)[linear.rates] / 2
        assert sum(energies.of_shape(z).values()) == pytest.approx(work, rel=1e-6)


def test_names_tell_who_moves_against_whom():
    _, modes = described("rig-2mw")
    names = [mode.name for mode in modes]
    assert names[0] == "generator against motor over input_shaft"
    assert "psh.input against psh.output over psh.mesh" in names
    assert {mode.name.split(" over ")[0] for mode in modes if mode.kind == "planet"} == {
        "lsp planets against each other"
    }
    assert [mode.name for mode in modes if next(iter(mode.strain)) == "lsp.ring.bearing"] == [
        "lsp.ring on its bearing"
    ] * 2
    assert "lsp against hsp over lsp_hsp" in names
    rigid = described("lin-parker-3")[1][0]
    assert rigid.name == "gear.carrier, gear planets, gear.sun as one"


def test_a_member_that_is_not_held_sideways_is_called_after_its_mesh():
    _, modes = described("lin-parker-3", 'stages.gear.sun.support = "floating"', "-stages.gear.sun.bearing")
    assert not any("gear.sun.bearing" in mode.strain for mode in modes)
    assert {mode.name for mode in modes if next(iter(mode.members)) == "gear.sun"} == {
        "gear.sun against gear planets over gear.sun_planet"
    }


def test_equal_meshes_share_as_the_squares_of_their_deflections():
    """U = k delta^2 / 2 of every mesh of an unloaded gear, with the printed k."""
    linear, modes = described("lin-parker-4")
    energies, deflections = Energies(linear), linear.outputs("mesh_deflection")
    for mode in modes[1:]:
        found = energies.of_shape(mode.shape)
        total = sum(found.values())
        for mesh, row in deflections.items():
            wanted = lin_parker.K_MESH["sun"] * abs(row @ mode.shape) ** 2 / 2
            assert found[mesh] == pytest.approx(wanted, rel=1e-9, abs=1e-12 * total)
