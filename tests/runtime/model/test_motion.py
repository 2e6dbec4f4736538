"""`motion`, which is what is integrated, gives just what `rhs`, `energy` and `outputs` give one by one."""

import numpy as np
import pytest
from ltcgear.runtime.model.building import build
from ltcgear.runtime.model.function import Kernel
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.emit.pipeline import obtain

from ..everything import covering, everything
from ..models import Case, case

VARIANTS = list(covering())[::7]
STATES = 20


def same(one, two):
    """Whether two results differ by no more than the rounding of the largest."""
    return np.abs(one - two).max(initial=0) <= 1e-10 * np.abs(two).max(initial=0)


def assert_joined(c):
    manifest = c.library.manifest
    called = {name: Kernel(c.library.functions[name]) for name in ("motion", "rhs", "energy", "outputs")}
    meshes = [i for i, report in enumerate(manifest.reports) if report.quantity == "mesh_force"]
    rng = np.random.default_rng(5)
    for _ in range(STATES):
        s = rng.uniform(0, 1, len(manifest.levels) + len(manifest.signals))
        arguments = c.at.x + 1e-5 * rng.uniform(-1, 1, len(c.at.x)), s, c.p
        xdot, power, force = called["motion"](*arguments)
        balance = called["energy"](*arguments)[0]
        assert same(xdot, called["rhs"](*arguments)[0])
        assert abs(power[0] - (balance[3] - balance[4])) <= 1e-10 * (abs(balance[3]) + abs(balance[4]))
        assert same(force, called["outputs"](*arguments)[0][meshes])


@pytest.mark.parametrize("name", ["rig-2mw", "lin-parker-3", "hard-friction", "start-up"])
def test_motion_of_shipped_scenes(name):
    c = case(name)
    assert_joined(c)
    wanted = [report.item for report in c.library.manifest.reports if report.quantity == "mesh_force"]
    assert c.library.manifest.functions["motion"].results[2] == ("force", len(wanted), 1 if wanted else 0)


@pytest.mark.parametrize("k", range(len(VARIANTS)))
def test_motion_of_all_effects(k):
    scene = everything(VARIANTS[k])
    model = build_model(scene)
    assert_joined(Case(scene, model, build(obtain(model))))


def test_motion_is_cheaper_than_its_parts():
    functions = case("rig-2mw").library.manifest.functions
    parts = [functions[name].operations for name in ("rhs", "energy", "outputs")]
    assert functions["rhs"].operations < functions["motion"].operations < 0.7 * sum(parts)
