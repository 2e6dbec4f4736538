"""Random stages of a handful of structures: numbers vary, so hardly anything is compiled twice."""

from functools import cache
from math import pi, sin

import numpy as np
from hypothesis import strategies as st
from ltcgear.runtime.model.building import build
from ltcgear.runtime.model.equilibrium import find_equilibrium
from ltcgear.runtime.model.function import Kernel
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.emit.pipeline import obtain
from ltcgear.symbolic.scene.load import make_scene


@cache
def library_of(structure, holder):
    """Build the library of a structure once; ``holder`` carries the model past the cache."""
    return build(obtain(holder.model))


class _Holder:
    """Equal to every other, so that the structure alone is the cache's key."""

    def __init__(self, model):
        self.model = model

    def __eq__(self, other):
        return isinstance(other, _Holder)

    def __hash__(self):
        return 0


class Stage:
    """A built scene."""

    def __init__(self, raw):
        self.model = build_model(make_scene(raw))
        self.library = library_of(self.model.structure(), _Holder(self.model))
        self.p = self.library.parameters(self.model.values())
        self.manifest = self.library.manifest

    def equilibrium(self):
        """Return the loaded equilibrium."""
        return find_equilibrium(self.library, self.p)

    def outputs(self, at, quantity="mesh_force"):
        """Return item -> value of a quantity at an equilibrium."""
        values = Kernel(self.library.functions["outputs"])(at.x, at.s, self.p)[0]
        pairs = zip(self.manifest.reports, values.tolist(), strict=True)
        return {report.item: value for report, value in pairs if report.quantity == quantity}

    def forces(self):
        """Return mesh -> normal force [N] at the equilibrium."""
        return self.outputs(self.equilibrium())

    def random_state(self, seed):
        """Return a state near the rigid motion: deflections of about 10 um, vibration speeds of about 1 cm/s."""
        rng, at = np.random.default_rng(seed), self.equilibrium()
        x = at.x.copy()
        x[self.library.index("")] += 1e-5 * rng.normal(size=len(self.library.index("")))
        x[self.library.index(".rate")] += 1e-2 * rng.normal(size=len(self.library.index("")))
        return x, at.s


def around(middle, spread=3.0):
    """Numbers about a middle, a factor up or down."""
    return st.floats(-1.0, 1.0).map(lambda power: float(f"{middle * spread**power:.6g}"))


def member(draw, mass, radius, support):
    """A member: mass, inertia of a disc, support."""
    weight = draw(around(mass))
    given = {"mass": f"{weight} kg", "inertia": f"{weight * radius**2 / 2:.9g} kg*m^2", "support": support}
    if support == "bearing":
        given["bearing"] = {"stiffness": f"{draw(around(3e8))} N/m", "damping_ratio": draw(st.floats(0.01, 0.1))}
    return given


def mesh(draw):
    """A mesh of constant stiffness."""
    ratio = draw(st.floats(0.01, 0.1))
    return {"stiffness": f"{draw(around(5e8))} N/m", "damping_ratio": ratio, "backlash": "0.1 mm"}


@st.composite
def pairs(draw, contact=("bilateral", "backlash")):
    """External pairs on bearings, at speed and under load, either way round."""
    one, two, module = draw(st.integers(18, 50)), draw(st.integers(18, 90)), draw(st.sampled_from([2, 3, 5]))
    radii = one * module * 5e-4, two * module * 5e-4
    stage = {
        "kind": "pair", "module": f"{module} mm", "pressure_angle": f"{draw(st.sampled_from([17.5, 20, 25]))} deg",
        "line_of_centres": f"{draw(st.integers(-180, 180))} deg",
        "input": {"teeth": one, **member(draw, 4, radii[0], "bearing")},
        "output": {"teeth": two, **member(draw, 9, radii[1], "bearing")}, "mesh": mesh(draw),
    }  # fmt: skip
    return _scene(draw, stage, ("input", "output"), draw(st.sampled_from(contact)), radii[1])


@st.composite
def planetaries(draw, planets=(3, 4, 5), sun=("bearing", "floating"), contact=("bilateral", "one-flank"), errors=False):
    """Planetary stages with a fixed ring, sun driven and carrier braked; with ``errors`` pins are out of place."""
    n = draw(st.sampled_from(planets))
    z_s = draw(st.integers(20, 40))
    fits = [z for z in range(16, 45) if 2 * (z_s + z) % n == 0 and (z_s + z) * sin(pi / n) > z + 2]
    z_p, module = draw(st.sampled_from(fits)), draw(st.sampled_from([2, 3, 5]))
    size = module * 5e-4
    stage = {
        "kind": "planetary", "planets": n, "module": f"{module} mm", "pressure_angle": "20 deg",
        "ring": {"teeth": z_s + 2 * z_p, "support": "fixed"},
        "sun": {"teeth": z_s, **member(draw, 3, z_s * size, draw(st.sampled_from(sun)))},
        "planet": {"teeth": z_p, **member(draw, 2, z_p * size, "floating")},
        "carrier": member(draw, 20, (z_s + z_p) * size, "bearing"),
        "sun_planet": mesh(draw), "ring_planet": mesh(draw),
        "pin": {"stiffness": f"{draw(around(3e8))} N/m", "damping_ratio": 0.03},
    }  # fmt: skip
    del stage["planet"]["support"]
    if errors:
        stage["position_errors"] = [
            {
                "planet": i + 1,
                "tangential": f"{draw(st.integers(-20, 20))} um",
                "radial": f"{draw(st.integers(-20, 20))} um",
            }
            for i in range(n)
        ]
    return _scene(draw, stage, ("sun", "carrier"), draw(st.sampled_from(contact)), z_s * size, errors)


def _scene(draw, stage, ends, contact, radius, errors=False):
    """Put a stage under load: a speed at one end, a torque at the other."""
    sign = draw(st.sampled_from([-1, 1]))
    torque = sign * radius * draw(around(2e4))
    effects = {"mesh_stiffness": "mean", "contact": contact}
    effects |= {"planet_position_error": "on"} if errors else {}
    return {
        "title": "random stage", "effects": effects, "stages": {"g": stage},
        "loads": {
            "drive": {"member": f"g.{ends[0]}", "speed": f"{draw(st.integers(-1000, 1000))} rpm"},
            "brake": {"member": f"g.{ends[1]}", "torque": f"{torque:.9g} N*m"},
        },
    }  # fmt: skip
