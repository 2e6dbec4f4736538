"""What effects cost and buy: measures against closed forms, rows that ran and rows that could not."""

from math import pi

import numpy as np
import pytest
import xarray as xr
from ltcgear.generated.errors import LtcgearError, SolverError
from ltcgear.runtime.studies.cost import Variant, measure_costs
from ltcgear.runtime.studies.force_comparison import MEASURES, compare_forces, mesh_orders, pair_orders, share_loads
from ltcgear.runtime.view.figures.cost_figures import check_figure, draw_costs

from ..models import case

RATE, TIME = 4096.0, np.arange(4096) / 4096.0
MESHES = ["a.sun_planet.1", "a.sun_planet.2", "b.mesh"]


def result(forces, speed=40.0, meshes=MESHES):
    """A result with three meshes; ``forces`` are their histories."""
    values = np.array([np.broadcast_to(force, TIME.shape) for force in forces]).T
    phases = np.tile(speed * TIME[:, None], (1, len(forces)))
    meshes = meshes[: len(forces)]
    return xr.Dataset(
        {"mesh_force": (("time", "mesh"), values), "mesh_phase": (("time", "mesh"), phases)},
        coords={"time": TIME, "mesh": meshes},
    )


def wave(amplitude, order=1, speed=40.0):
    return amplitude * np.sin(2 * pi * order * speed * TIME + 0.4)


FULL = result([100 + wave(10), 80 + wave(10), 50 + wave(5, 2)])


def test_the_same_run_shows_zero_everywhere():
    assert compare_forces(FULL, FULL) == {
        "a": dict.fromkeys(MEASURES, 0.0),
        "b": dict.fromkeys(MEASURES, 0.0) | {"load_share": None},
    }


def test_changes_are_the_closed_forms():
    found = compare_forces(FULL, result([90 + wave(10), 90 + wave(4), 50 + wave(5, 2) + wave(2, 3)]))
    assert found["a"]["force_rms"] == pytest.approx(-0.6, abs=1e-3)
    assert found["a"]["force_peak"] == pytest.approx(-10 / 110, abs=1e-3)
    assert found["a"]["load_share"] == pytest.approx(1.0 - 100 / 90, abs=1e-3)
    assert found["a"]["spectrum"] == pytest.approx(0.6, abs=1e-3)
    assert found["b"]["force_rms"] == pytest.approx((29**0.5 - 5) / 5, abs=1e-3)
    assert found["b"]["spectrum"] == pytest.approx(2 / 5, abs=2e-3)


def test_a_mesh_that_is_not_there_counts_as_unloaded():
    found = compare_forces(FULL, result([100 + wave(10)]))
    assert found["a"]["force_rms"] == found["b"]["force_peak"] == -1.0
    assert found["a"]["load_share"] == pytest.approx(2.0 - 100 / 90, abs=1e-3)


def test_a_force_on_the_other_flank_is_the_force_of_its_mesh():
    """A bilateral mesh pulls with what presses the other flank of one with backlash: nothing has changed."""
    pulls = result([-100 - wave(10)], meshes=["b.mesh"])
    presses = result([0.0, 100 + wave(10)], meshes=["b.mesh", "b.mesh.back"])
    for found in (compare_forces(pulls, presses), compare_forces(presses, pulls)):
        assert found == {"b": dict.fromkeys(MEASURES, 0.0) | {"load_share": None}}


def test_nothing_to_refer_to_is_none_not_infinite():
    still = result([100.0, 80.0, 50.0])
    assert compare_forces(still, FULL)["a"]["force_rms"] is None
    assert compare_forces(still, FULL)["b"]["spectrum"] is None
    assert compare_forces(result([0.0, 0.0]), FULL)["a"]["load_share"] is None
    slow = result([100 + wave(10), 80 + wave(10)], speed=2.0)
    assert compare_forces(slow, FULL)["a"]["spectrum"] is None
    assert compare_forces(FULL.drop_vars("mesh_force"), FULL) == {}


def test_shares_are_of_planets_that_carry():
    one = {"a.sun_planet.1": TIME + 1, "a.sun_planet.2": -TIME - 1, "b.mesh": TIME, "c.sun_planet.1": 0 * TIME}
    one["c.sun_planet.2"] = one["c.sun_planet.1"]
    shares = share_loads(one, one | {"a.sun_planet.1": 3 * TIME + 3}, [list(one)[:2], ["b.mesh"], list(one)[3:]])
    assert list(shares) == [("a.sun_planet.1", "a.sun_planet.2")]
    before, after = shares["a.sun_planet.1", "a.sun_planet.2"]
    assert before.tolist() == [1.0, 1.0]
    assert after == pytest.approx([1.5, 0.5])


def test_a_force_that_stands_still_has_no_orders_to_compare():
    phase = 40 * TIME
    assert [len(found) for found in pair_orders(100 + 1e-5 * wave(1), wave(1), phase)] == [0, 0]
    before, after = pair_orders(wave(1), wave(2), phase)
    assert after == pytest.approx(2 * before)


def test_orders_follow_a_mesh_that_speeds_up():
    phase = 40 * TIME + 25 * TIME**2
    amplitudes = mesh_orders(30 + 3 * np.cos(2 * pi * phase) + 0.5 * np.cos(2 * pi * 4 * phase + 1), phase)
    expected = np.zeros(len(amplitudes))
    expected[[0, 3]] = 3.0, 0.5
    assert amplitudes == pytest.approx(expected, abs=3e-3)
    assert len(amplitudes) == int(0.4 * RATE / 90)


def variant(name, *settings, **keys):
    found = case(name, *settings)
    return Variant(*keys.pop("labels", ("all", "", "")), found.library, found.model.values())


@pytest.fixture(scope="module")
def rows():
    """The high-speed pair, with an effect out, with nothing changed, and with what cannot run."""
    no_balance = 'loads.input = { member = "lsp.ring", torque = "1 N*m" }'
    return measure_costs(
        [
            variant("psh"),
            variant("psh", "effects.mesh_stiffness = 'mean'", labels=("mesh_stiffness", "two-level", "mean")),
            variant("psh", labels=("contact", "bilateral", "bilateral")),
            Variant("gravity", "on", "off", None, {}, "it is not possible"),
            variant("lsp", no_balance, "-loads.ring", labels=("no", "equilibrium", "here")),
        ],
        t_end=0.02,
        rate=16384.0,
        rtol=1e-6,
    )


def test_rows_hold_cost_and_benefit(rows):
    full, mean, same, impossible, loose = rows
    assert full["reason"] == mean["reason"] == same["reason"] == ""
    assert full["counts"]["events"] > 10
    assert mean["counts"]["events"] == 0
    assert mean["ops"]["rhs"] < full["ops"]["rhs"]
    assert mean["states"] == full["states"]
    assert all(row["ns_call"] > 1 and row["seconds_per_simulated_second"] > 0 for row in (full, mean, same))
    assert mean["changes"]["force_rms"] == pytest.approx(-1.0, abs=1e-3)
    assert mean["changes"]["spectrum"] == pytest.approx(1.0, abs=1e-3)
    assert same["changes"] == dict.fromkeys(MEASURES, 0.0) | {"load_share": None}
    assert (impossible["reason"], impossible["states"]) == ("it is not possible", None)
    assert "equilibrium" in loose["reason"]
    assert loose["changes"] == dict.fromkeys(MEASURES)


def test_a_run_that_fails_is_a_row_with_its_reason(monkeypatch):
    from ltcgear.runtime.studies import cost

    whole = cost.simulate

    def failing(library, values, **options):
        found = whole(library, values, **options)
        if len(library.manifest.levels) == 0:
            found.summary["status"] = "erk stopped at t = 0.001 s"
        return found

    monkeypatch.setattr(cost, "simulate", failing)
    two = variant("psh"), variant("psh", "effects.mesh_stiffness = 'mean'", labels=("mesh_stiffness", "", "mean"))
    keys = {"t_end": 0.002, "rate": 16384.0, "rtol": 1e-6}
    rows = measure_costs(two, **keys)
    assert (rows[0]["reason"], rows[1]["reason"]) == ("", "erk stopped at t = 0.001 s")
    assert rows[1]["seconds_per_simulated_second"] is None
    with pytest.raises(SolverError, match="erk stopped"):
        measure_costs(two[::-1], **keys)


def test_the_figure_is_drawn(rows, tmp_path):
    path = draw_costs({"scene": "psh", "variants": rows}, tmp_path / "cost.png")
    assert path.read_bytes().startswith(b"\x89PNG")
    text = draw_costs({"scene": "psh", "variants": rows}, tmp_path / "cost.svg").read_text()
    assert "cannot be run" in text or "<svg" in text


def test_a_figure_of_unknown_format_is_refused(tmp_path):
    with pytest.raises(LtcgearError, match=r"name it .*x\.png"):
        check_figure(tmp_path / "x.jpg")
    with pytest.raises(LtcgearError, match="does not exist"):
        check_figure(tmp_path / "no" / "x.png")
