"""Scenes built once for all tests: what a scene's file says, changed by settings, down to its equilibrium."""

import os
import tomllib
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any

import numpy as np
import pytest
from ltcgear.generated.compiler import MORE_FLAGS
from ltcgear.runtime.model.building import build
from ltcgear.runtime.model.equilibrium import find_equilibrium
from ltcgear.runtime.model.library import Library
from ltcgear.runtime.model.operating_point import OperatingPoint
from ltcgear.runtime.model.rows import over_time
from ltcgear.runtime.model.state_matrix import Equilibrium
from ltcgear.runtime.simulation.integrate import integrate
from ltcgear.runtime.simulation.run_settings import RunSettings
from ltcgear.runtime.simulation.trajectory import Trajectory
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.emit.pipeline import obtain
from ltcgear.symbolic.mechanics.model import Model
from ltcgear.symbolic.scene.load import SHIPPED, make_scene
from ltcgear.symbolic.schema.scene_schema import Scene

MESHES = {
    "lsp": ("lsp.sun_planet", "lsp.ring_planet"),
    "hsp": ("hsp.sun_planet", "hsp.ring_planet"),
    "psh": ("psh.mesh",),
}
"""The meshes of the rig's stages."""


@dataclass(frozen=True)
class Case:
    """A scene, its model and its library."""

    scene: Scene
    model: Model
    library: Library

    @cached_property
    def p(self) -> np.ndarray:
        return self.library.parameters(self.model.values())

    @cached_property
    def at(self) -> Equilibrium:
        return find_equilibrium(self.library, self.p, tables=self.model.tables)

    @cached_property
    def point(self) -> OperatingPoint:
        return OperatingPoint(self.library, self.p, self.at)

    def state(self, name: str) -> int:
        """The index of a state."""
        return [state.name for state in self.library.manifest.states].index(name)

    def outputs(self, x: np.ndarray, levels: np.ndarray) -> dict[tuple[str, str], np.ndarray]:
        """(quantity, item) -> values, of states and levels of shape (times, ...)."""
        y = over_time(self.library, "outputs", np.atleast_2d(x), np.atleast_2d(levels), self.p)
        return {(r.quantity, r.item): y[:, i] for i, r in enumerate(self.library.manifest.reports)}

    def quantity(self, name: str, x: np.ndarray, levels: np.ndarray) -> dict[str, np.ndarray]:
        """Item -> values of one quantity."""
        return {item: values for (quantity, item), values in self.outputs(x, levels).items() if quantity == name}

    def mesh_forces(self, path: Trajectory) -> np.ndarray:
        """All mesh forces of a run, shape (times, meshes)."""
        return np.array(list(self.quantity("mesh_force", path.x, path.s).values())).T

    def run(self, **options: Any) -> Trajectory:
        """Integrate from the equilibrium, or from another start given as ``at``."""
        at, told = options.pop("at", None) or self.at, options.pop("told", lambda t: None)
        options = {
            "tables": self.model.tables,
            "t_end": 0.1,
            "rate": 8192.0,
            "method": "cvodes",
            "rtol": 1e-7,
        } | options
        return integrate(OperatingPoint(self.library, self.p, at), RunSettings(**options), told)


def raw_scene(name: str, *settings: str) -> dict[str, Any]:
    """A shipped scene as TOML gives it; ``key = value`` puts, ``-key`` takes away."""
    raw = tomllib.loads((SHIPPED / f"{name}.toml").read_text(encoding="utf-8"))
    for setting in settings:
        change(raw, setting)
    return raw


def change(raw: dict[str, Any], setting: str) -> None:
    """Make one change to a raw scene."""
    key, put, value = setting.lstrip("-").partition(" = ")
    *path, last = key.split(".")
    for part in path:
        raw = raw.setdefault(part, {})
    if put:
        raw[last] = tomllib.loads(f"v = {value}")["v"]
    else:
        del raw[last]


def make_case(raw: dict[str, Any]) -> Case:
    """Build a raw scene."""
    scene = make_scene(raw)
    model = build_model(scene)
    return Case(scene, model, build(obtain(model)))


@cache
def case(name: str, *settings: str) -> Case:
    """Build a shipped scene with settings (see ``raw_scene``), once a session."""
    return make_case(raw_scene(name, *settings))


@cache
def quick_case(name: str, *settings: str) -> Case:
    """Build as ``case`` does, the C compiled without optimisation: for large models that are hardly run.

    Those with many effects at once compile for half a minute otherwise, in a tenth of that so. A session that sets
    flags of its own keeps them.
    """
    with pytest.MonkeyPatch.context() as patch:
        if os.environ.get(MORE_FLAGS, "-O1") == "-O1":
            patch.setenv(MORE_FLAGS, "-O0")
        return make_case(raw_scene(name, *settings))


@cache
def run(name: str, *settings: str, **options: Any) -> Trajectory:
    """Integrate a case from its equilibrium, once a session."""
    return case(name, *settings).run(**options)


TORQUE_DRIVEN = (
    "-loads.motor.speed",
    'loads.motor.torque = "1.5e6 N*m"',
    'loads.motor.initial_speed = "15 rpm"',
)
"""The rig with the motor's torque given instead of its speed; it does not balance the load."""
