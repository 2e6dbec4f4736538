"""The hand-written C of the rig: compiled with the flags of the generated C, filled, called and timed."""

import ctypes
from collections.abc import Callable
from pathlib import Path
from time import perf_counter

import numpy as np
from ltcgear.generated import store
from ltcgear.generated.errors import LtcgearError
from numpy.typing import NDArray

from .rig import Rig

Vector = NDArray[np.float64]
HERE = Path(__file__).parent
BODIES = (
    ["lsp.ring", "lsp.sun", *(f"lsp.planet.{i}" for i in range(1, 5)), "hsp.carrier", "hsp.sun"]
    + [f"hsp.planet.{i}" for i in range(1, 4)] + ["psh.input", "psh.output"]
)  # fmt: skip
MESHES = {
    "l_sun": "lsp.sun_planet", "l_ring": "lsp.ring_planet", "h_sun": "hsp.sun_planet", "h_ring": "hsp.ring_planet",
    "pair": "psh.mesh",
}  # fmt: skip
SPRINGS = {
    "l_pin": "lsp.pin", "h_pin": "hsp.pin", "l_ring_bearing": "lsp.ring.bearing", "h_sun_bearing": "hsp.sun.bearing",
    "input_bearing": "psh.input.bearing", "output_bearing": "psh.output.bearing",
}  # fmt: skip
COUPLINGS = ("input_shaft", "lsp_hsp", "hsp_psh", "output_shaft", "flange")
TIMES, BLOCKS, CALLS = 2000, 60, 300
"""Calls in a timed block of C, blocks of each side, calls in a block of Python."""


def structure(*names: str) -> type[ctypes.Structure]:
    """Make a C structure of doubles."""
    return type("_".join(names), (ctypes.Structure,), {"_fields_": [(name, ctypes.c_double) for name in names]})


Mesh = structure("r1", "r2", "flank", "inv0", "k1", "k2", "c")
Spring, Place, Reciprocal = structure("k", "c"), structure("x", "y"), structure("mass", "inertia")


class Parameters(ctypes.Structure):
    """The structure ``Rig`` of floor.c."""

    _fields_ = (
        *((name, Mesh) for name in MESHES),
        *((name, Spring) for name in SPRINGS),
        ("coupling", Spring * len(COUPLINGS)),
        ("body", Reciprocal * len(BODIES)),
        ("place", Place * len(BODIES)),
        ("towards", Place * len(BODIES)),
        *((n, ctypes.c_double) for n in ("shaft_inertia", "generator_inertia", "speed", "frame_speed", "torque")),
    )


def parameters(rig: Rig) -> Parameters:
    """Fill the structure with the numbers of the rig."""
    v, found = rig.values, Parameters()
    for field, name in MESHES.items():
        single = v.get(f"{name}.stiffness_single", v.get(f"{name}.stiffness"))
        double = v.get(f"{name}.stiffness_double", single)
        numbers = (v[f"{name}.{key}"] for key in ("base_radius_1", "base_radius_2", "flank", "inv_alpha_0"))
        setattr(found, field, Mesh(*numbers, single, double, v[f"{name}.damping"]))
    springs = {field: getattr(found, field) for field in SPRINGS}
    for spring, name in (
        *((springs[field], name) for field, name in SPRINGS.items()),
        *((found.coupling[i], f"couplings.{name}") for i, name in enumerate(COUPLINGS)),
    ):
        spring.k, spring.c = v[f"{name}.stiffness"], v[f"{name}.damping"]
    for i, name in enumerate(BODIES):
        kind = name.rstrip(".1234567890")
        found.body[i] = Reciprocal(1 / v[f"{kind}.mass"], 1 / v[f"{kind}.inertia"])
        x, y = (v.get(f"{name}.{axis}_0", 0.0) for axis in "xy")
        far = np.hypot(x, y) or 1.0
        found.place[i], found.towards[i] = Place(x, y), Place(x / far, y / far)
    found.shaft_inertia, found.generator_inertia = 1 / v["shaft.inertia"], 1 / v["generator.inertia"]
    found.speed, found.torque = v["reference.speed"], v["loads.generator.torque"]
    found.frame_speed = v["hsp.carrier.speed_ratio"] * v["reference.speed"]
    return found


def compiled(name: str, before: str = "") -> ctypes.CDLL:
    """Compile a C file of this folder, with a text before it, as the generated C is compiled."""
    compiler = store.compiler()
    if compiler is None:
        raise LtcgearError("no C compiler found: install gcc or clang, the peers cannot be timed without one")
    return ctypes.CDLL(str(store.library(before + (HERE / f"{name}.c").read_text("utf-8"), compiler)))


def address(values: NDArray[np.generic]) -> ctypes.c_void_p:
    """Return where the numbers of an array are."""
    return ctypes.c_void_p(values.ctypes.data)


class Floor:
    """The right-hand side of floor.c; ``merged`` takes one arc tangent a mesh in place of two."""

    def __init__(self, rig: Rig, merged: bool = False) -> None:
        self.function = compiled("floor", "#define MERGED\n" * merged).floor_rhs
        self.parameters = parameters(rig)
        self.out = np.zeros(len(rig.at.x))

    def __call__(self, x: Vector, levels: Vector) -> Vector:
        """Return x', valid until the next call."""
        self.function(address(x), address(levels), ctypes.byref(self.parameters), address(self.out))
        return self.out


def call_times(rig: Rig, floors: dict[str, Floor]) -> dict[str, list[float]]:
    """Time one call in a loop of C [s], ``generated`` and those written by turns: a list of ``BLOCKS`` for each."""
    loop, function = compiled("loop"), rig.library.functions["rhs"]
    if rig.library.path is None:
        raise LtcgearError("the model is not compiled: install a C compiler")
    generated = ctypes.CDLL(str(rig.library.path)).rhs
    x, levels, out = rig.at.x.copy(), rig.at.levels.copy(), np.zeros(len(rig.at.x))
    given, taken = (ctypes.c_void_p * max(function.sz_arg(), 3))(), (ctypes.c_void_p * max(function.sz_res(), 1))()
    for i, array in enumerate((x, levels, rig.p)):
        given[i] = array.ctypes.data
    taken[0] = out.ctypes.data
    whole, real = np.zeros(max(function.sz_iw(), 1), dtype=np.int64), np.zeros(max(function.sz_w(), 1))
    times = ctypes.c_long(TIMES)

    def written(floor: Floor) -> Callable[[], object]:
        numbers = address(x), address(levels), ctypes.byref(floor.parameters), address(floor.out)
        return lambda: loop.loop_written(floor.function, *numbers, times)

    sides = {name: written(floor) for name, floor in floors.items()}
    sides["generated"] = lambda: loop.loop_generated(generated, given, taken, address(whole), address(real), times)
    found: dict[str, list[float]] = {name: [] for name in sides}
    for _ in range(BLOCKS):
        for name, side in sides.items():
            clock = perf_counter()
            side()
            found[name].append((perf_counter() - clock) / TIMES)
    return found


def python_time(call: Callable[[], object]) -> float:
    """Return the least time of a call from Python [s]."""
    found = []
    for _ in range(20):
        clock = perf_counter()
        for _ in range(CALLS):
            call()
        found.append((perf_counter() - clock) / CALLS)
    return min(found)
