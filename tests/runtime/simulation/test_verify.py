"""The estimate of accuracy against the true error, and runs that part."""

import numpy as np
import pytest
from ltcgear.runtime.results.dataset import make_dataset
from ltcgear.runtime.results.signal_errors import compare_signals
from ltcgear.runtime.simulation.output_reader import no_rows
from ltcgear.runtime.simulation.run_settings import RunSettings
from ltcgear.runtime.simulation.simulate import simulate
from ltcgear.runtime.simulation.verify import TOLD, estimate_accuracy, tell_parting
from scipy.integrate import solve_ivp

from ..models import case, run


@pytest.mark.parametrize("rtol", [1e-4, 1e-5, 1e-6, 1e-7])
@pytest.mark.parametrize("scene", ["lsp", "rig-2mw"])
def test_the_estimate_is_the_true_error(scene, rtol):
    c, options = case(scene), {"method": "erk", "t_end": 0.05, "rate": 8192.0}
    estimate = estimate_accuracy(c.point, RunSettings(rtol=rtol, **options))
    path, best = (run(scene, rtol=tolerance, **options) for tolerance in (rtol, 1e-11))
    names = [str(name) for name in make_dataset(c.library, c.p, no_rows(c.library))["mesh"].values]
    forces = np.array([c.mesh_forces(path), c.mesh_forces(best)])
    together = (path.levels == best.levels).all(axis=1)
    assert together.mean() > 0.99
    assert estimate["reason"] is None
    assert list(estimate["meshes"]) == names
    for i, name in enumerate(names):
        for key, true in compare_signals(*forces[:, together, i]).items():
            assert true / 3 < estimate["meshes"][name][key] < 3 * true
        # Means are integrals; extremes are seen at steps, and RMS at points that resolve it to a millionth.
        told = {key: estimate["meshes"][name][key] for key in TOLD}
        assert told["mean"] < 3e-7
        assert max(told["rms"], told["max"], told["load_factor"]) < rtol + 1e-5
    assert estimate["worst"] in names


def duffing(rtol, damping, force):
    """Ueda's oscillator x'' + d x' + x^3 = F cos t, sampled; chaotic for d = 0.05 and F = 7.5 (Ueda 1979)."""
    times = np.arange(0, 200, 0.1)

    def rate(t, y):
        return [y[1], force * np.cos(t) - damping * y[1] - y[0] ** 3]

    return solve_ivp(rate, (0, 200), [1.0, 0.0], t_eval=times, rtol=rtol, atol=rtol, method="DOP853").y[0]


@pytest.mark.parametrize(("damping", "force", "chaotic"), [(0.05, 7.5, True), (0.4, 0.5, False)])
def test_only_chaotic_runs_part(damping, force, chaotic):
    forces = np.array([duffing(rtol, damping, force)[:, None] for rtol in (1e-6, 1e-7)])
    reason = tell_parting(forces, np.ones(forces.shape[1], bool), 200.0)
    assert (reason is not None) == chaotic


def test_a_coarse_run_is_not_said_to_part():
    c = case("lsp")
    estimate = estimate_accuracy(c.point, RunSettings(t_end=0.1, rate=8192.0, method="cvodes", rtol=1e-2))
    assert estimate["reason"] is None
    assert estimate["meshes"][estimate["worst"]]["peak_over_vibration"] > 1e-2


def test_simulate_verifies_on_demand():
    c = case("psh")
    options = {"t_end": 0.05, "rate": 8192.0}
    assert "accuracy" not in simulate(c.library, c.model.values(), **options).summary
    found = simulate(c.library, c.model.values(), verify=True, rtol=1e-5, **options)
    assert found.summary["accuracy"]["worst"] == "psh.mesh"
    assert 0 < found.summary["accuracy"]["meshes"]["psh.mesh"]["rms_over_vibration"] < 1e-3
    assert "worst" in found.dataset.attrs["accuracy"]


def test_a_model_that_stands_still_has_no_estimate_over_its_vibration():
    c = case("psh", 'effects.mesh_stiffness = "mean"')
    estimate = estimate_accuracy(c.point, RunSettings(t_end=0.01, rate=8192.0, method="erk", rtol=1e-6))
    assert all(mesh["rms_over_vibration"] is None for mesh in estimate["meshes"].values())
