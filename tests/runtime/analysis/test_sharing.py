"""Load shares of planets, of forces that are known."""

import numpy as np
import pytest
from ltcgear.generated.errors import LtcgearError
from ltcgear.runtime.analysis import (
    find_load_share,
)

from ..outputs import result, times

TIME = times()
TURN = 2 * np.pi
WAVE = np.sin(TURN * 8.0 * TIME)


def planets(*forces):
    return result(TIME, mesh_force={f"lsp.sun_planet.{k}": force for k, force in enumerate(forces, start=1)})


def test_shares_of_known_forces():
    found = find_load_share(planets(80.0 + 10.0 * WAVE, 100.0, 120.0 - 10.0 * WAVE, 100.0), "lsp.sun_planet")
    assert found.mean == pytest.approx([0.8, 1.0, 1.2, 1.0])
    assert found.mesh_load_factor == pytest.approx(1.2)
    assert found.highest == pytest.approx([0.9, 1.0, 1.3, 1.0])
    assert found.lowest == pytest.approx([0.7, 1.0, 1.1, 1.0])
    assert found.largest == pytest.approx(1.3)
    assert found.share.sum(axis=1) == pytest.approx(4.0)


def test_shares_on_the_other_flank_are_the_same():
    found = find_load_share(planets(-80.0, -120.0), "lsp.sun_planet")
    assert found.mean == pytest.approx([0.8, 1.2])
    assert found.share[0] == pytest.approx([0.8, 1.2])


def test_where_no_load_is_carried_there_is_no_share():
    gone = np.where(TIME < 0.5, 1.0, 0.0)
    found = find_load_share(planets(90.0 * gone, 110.0 * gone), "lsp.sun_planet")
    assert np.isnan(found.share[TIME >= 0.5]).all()
    assert found.highest == pytest.approx([0.9, 1.1])


def test_groups_without_shares_are_refused():
    with pytest.raises(LtcgearError, match=r"psh.mesh: no group of several meshes; there are lsp.sun_planet"):
        find_load_share(planets(1.0, 1.0), "psh.mesh")
    with pytest.raises(LtcgearError, match="carries no load in the mean"):
        find_load_share(planets(WAVE, -WAVE), "lsp.sun_planet")
