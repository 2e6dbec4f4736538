"""The floating effect: a floating sun evens out what one misplaced pin does to the planets' loads."""

import numpy as np
import pytest

from ..models import case


def shares(scene, *settings):
    """Return each planet's share of the sun's load, 1 in the mean."""
    found = case(scene, *settings)
    from ltcgear.runtime.model.function import Kernel

    values = Kernel(found.library.functions["outputs"])(found.at.x, found.at.levels, found.p)[0]
    reports = found.library.manifest.reports
    forces = [v for r, v in zip(reports, values, strict=True) if r.quantity == "mesh_force" and "sun_planet" in r.item]
    return np.array(forces) / np.mean(forces)


def test_four_planets_share_in_opposite_pairs_under_a_floating_sun():
    """Of four planets, opposite ones carry alike when the sun finds its place (Bodas and Kahraman 2004)."""
    found = shares("floating-on")
    assert found[0] == pytest.approx(found[2], abs=2e-3)
    assert found[1] == pytest.approx(found[3], abs=2e-3)
    assert found[0] < 0.97 < 1.03 < found[1]


def test_a_floating_sun_evens_out():
    floating, stiff = shares("floating-on"), shares("floating-off")
    assert np.ptp(floating) < 0.7 * np.ptp(stiff)
    assert stiff[0] == pytest.approx(0.91, abs=0.01)


def test_three_planets_share_alike_under_a_floating_sun():
    """Three forces on a free sun balance only if they are equal, whatever the error."""
    error = ("effects.planet_position_error = 'on'", "stages.hsp.position_errors = [{planet=1, tangential='50 um'}]")
    free = ("stages.hsp.sun.support = 'floating'", "-stages.hsp.sun.bearing", "stages.hsp.carrier.support = 'rigid'")
    assert shares("hsp", *error, *free) == pytest.approx(np.ones(3), abs=3e-3)
    assert np.ptp(shares("hsp", *error, "stages.hsp.carrier.support = 'rigid'")) > 0.02


def test_an_error_of_nothing_changes_nothing():
    none = shares("floating-on", "stages.lsp.position_errors = [{planet=1, tangential='0 um'}]")
    assert none == pytest.approx(shares("lsp"), abs=1e-12)
