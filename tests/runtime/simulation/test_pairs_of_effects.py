"""Every pair of effects at work: it runs, it loses energy where it may, and of zero amplitude it does nothing."""

import shutil
import subprocess
from functools import cache

import numpy as np
import pytest
from ltcgear.generated import store
from ltcgear.runtime.model.building import build
from ltcgear.runtime.model.function import Kernel
from ltcgear.runtime.simulation.simulate import simulate
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.emit.pipeline import obtain
from ltcgear.symbolic.scene.load import load_scene, shipped_scenes
from ltcgear.symbolic.schema.effects import DEFAULTS

from ..everything import DISSIPATIVE, ZERO, acting, allowed, beside, covering, everything, labelled, without
from ..models import Case

VARIANTS = [pytest.param(variant, id=labelled(variant)) for variant in covering()]
QUICK = ("-std=c11", "-O0", "-fPIC", "-shared", "-Wall", "-Werror")


@pytest.fixture(autouse=True, scope="module")
def quick():
    """Compile without optimisation: many models that run for a moment each."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(store, "FLAGS", QUICK)
        yield


@cache
def whole(variant: tuple[tuple[str, str], ...], *settings: str) -> Case:
    """Generate and compile the scene with data for every effect."""
    scene = everything(dict(variant), *settings)
    model = build_model(scene)
    return Case(scene, model, build(obtain(model)))


def made(variant, *settings) -> Case:
    """The case of a variant, once a session."""
    return whole(tuple(variant.items()), *settings)


@pytest.mark.parametrize("variant", VARIANTS)
def test_every_pair_compiles_and_runs(variant):
    found = made(variant)
    assert found.library.path is not None or store.compiler() is None
    result = simulate(found.library, found.model.values(), t_end=0.01, rate=8192.0)
    assert result.summary["status"] == "done"
    assert abs(result.summary["energy_residual"]) < 1e-3
    for name, values in result.dataset.items():
        assert np.isfinite(values.values).all(), name


def random_states(found: Case, count: int = 50):
    """States about the equilibrium, by ten times the size of small vibrations, and random levels."""
    draw = np.random.default_rng(7)
    scale = 10 * found.point.scale
    for _ in range(count):
        levels = draw.integers(0, 2, len(found.at.levels)).astype(float)
        yield found.at.x + scale * draw.uniform(-1, 1, len(scale)), levels


@pytest.mark.parametrize("variant", VARIANTS)
def test_losses_never_feed_energy(variant):
    found = made(variant, *DISSIPATIVE)
    energy = Kernel(found.library.functions["energy"])
    balance = np.array([energy(x, levels, found.p)[0].copy() for x, levels in random_states(found)])
    assert np.isfinite(balance).all()
    given, lost = np.abs(balance[:, 3]).max(), balance[:, 4]
    assert lost.min() >= -1e-12 * max(given, lost.max())


def test_there_are_losses_to_judge():
    assert any(max(losses(made(variant))) > 0 for variant in covering())


def losses(found):
    """Power lost at random states [W]."""
    energy = Kernel(found.library.functions["energy"])
    return [energy(x, levels, found.p)[0][4] for x, levels in random_states(found, 5)]


# --- zero amplitude


def surroundings(effect, value):
    """What an effect is tried among: much that can act with it, and as little as there can be."""
    little = beside(effect, value, {name: without(name) for name in DEFAULTS})
    return [acting(effect, value), *([little] if allowed(*(little | {effect: without(effect)}).items()) else [])]


AMPLITUDES = [
    pytest.param(effect, value, variant, id=f"{effect}={value}, beside {labelled(variant)}")
    for effect, value in ZERO
    for variant in surroundings(effect, value)
]


def stepped(found: Case, start: np.ndarray, step: float, count: int) -> np.ndarray:
    """States under the classical Runge-Kutta method of constant step, shape (count, n): the same steps for all."""
    kernel, levels, x, path = Kernel(found.library.functions["rhs"]), found.at.levels, start, []

    def rate(state):
        return kernel(state, levels, found.p)[0].copy()

    for _ in range(count):
        k1 = rate(x)
        k2 = rate(x + step / 2 * k1)
        k3 = rate(x + step / 2 * k2)
        k4 = rate(x + step * k3)
        x = x + step / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
        path.append(x)
    return np.array(path)


@pytest.mark.parametrize(("effect", "value", "variant"), AMPLITUDES)
def test_zero_amplitude_is_the_same_as_left_out(effect, value, variant):
    zero = made(variant | {effect: value}, *ZERO[effect, value])
    off = made(variant | {effect: without(effect)}, *ZERO[effect, value])
    names = [[state.name for state in found.library.manifest.states] for found in (zero, off)]
    assert names[0] == names[1]
    scale = off.point.scale
    start = off.at.x + scale
    one, two = (found.outputs(start, found.at.levels) for found in (zero, off))
    forces = {(r.quantity, r.item): r.unit for r in off.library.manifest.reports if r.unit in ("N", "N*m")}
    assert {"mesh_force", "drive_torque"} <= {quantity for quantity, _ in forces}
    for key, unit in forces.items():
        size = max(np.abs(two[other]).max() for other in forces if forces[other] == unit)
        assert np.abs(one[key] - two[key]).max() <= 1e-12 * size, key
    step = 0.5 / off.point.fastest
    count = int(np.ceil(0.01 / step))
    with_zero, left_out = ((stepped(found, start, step, count) - start) / scale for found in (zero, off))
    # Places of 60 mm are rounded by 1e-17 m, which is 1e-10 of these vibrations: no two sums are nearer.
    assert np.abs(with_zero - left_out).max() <= 1e-9 * np.abs(left_out).max()


# --- the C


WARNINGS = (
    *("-Wall", "-Wextra", "-pedantic", "-Wshadow", "-Wvla", "-Wstrict-prototypes", "-Wconversion"),
    *("-Wcast-qual", "-Wdouble-promotion", "-Wfloat-equal", "-Wundef", "-Wunused-macros"),
)
NOT_MEANT = {
    "-Wno-unused-parameter": "every function of CasADi's has the same arguments, whether it uses them or not",
    "-Wno-missing-prototypes": "CasADi declares what it exports in no header; the loader knows it by name",
}


@pytest.mark.parametrize("name", shipped_scenes())
def test_the_c_of_shipped_scenes_is_free_of_warnings(name, tmp_path):
    compiler = shutil.which("gcc")
    if compiler is None:
        pytest.skip("gcc is not here, and the flags are its own")
    (tmp_path / "model.c").write_text(obtain(build_model(load_scene(name))).c, encoding="utf-8")
    command = [compiler, "-std=c11", "-O0", "-fsyntax-only", *WARNINGS, *NOT_MEANT, "model.c"]
    run = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
    assert (run.returncode, run.stderr) == (0, "")
