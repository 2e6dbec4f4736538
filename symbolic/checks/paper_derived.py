"""Derived rows of the paper: each of its equations from element wrenches or by counting."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

import numpy as np
import sympy as sp

from ..elements.axes import PLANE
from ..elements.base import Element
from ..elements.bearing import ground_bearing, pin, pin_friction
from ..elements.gravity import gravity
from ..elements.mesh import mesh
from ..elements.mesh_friction import mesh_friction
from ..elements.torsion import drag, external_torque
from .paper_states import COMPONENTS, KIND, STATES, Array, Values, random_values

Groups = dict[str, Array]
SIZES = (1e-2, 1e-4)

ELEMENTS: Mapping[str, Callable[[], Element]] = {
    "mesh_S": lambda: mesh("external", "paper", switched=False, damped=False),
    "mesh_R": lambda: mesh("internal", "paper", switched=False, damped=False),
    "involute_S": lambda: mesh("external", "involute", switched=False, damped=False),
    "involute_R": lambda: mesh("internal", "involute", switched=False, damped=False),
    "friction_S": lambda: mesh_friction("external", "paper", switched=False),
    "friction_R": lambda: mesh_friction("internal", "paper", switched=False),
    "pin": lambda: pin(damped=False),
    "pin_friction": pin_friction,
    "ground_bearing": lambda: ground_bearing(damped=False),
    "drag": drag,
    "gravity": gravity,
    "external_torque": external_torque,
}


@lru_cache
def compiled(name: str) -> tuple[Element, Callable[..., Any]]:
    """Make an element and the numeric function of its wrench."""
    element = ELEMENTS[name]()
    modules = [{"Switch": lambda g, hold: (g + hold > 0) * 1.0}, "numpy"]
    loads = [element.wrench.get((port, axis), sp.S.Zero) for port in element.ports for axis in PLANE]
    return element, sp.lambdify(element.arguments, loads, modules, cse=True)


def wrench(name: str, bodies: str, v: Values, parameters: Mapping[str, Any]) -> list[Array]:
    """Evaluate an element between bodies (``"SP"``: sun, then planet)."""
    element, function = compiled(name)
    known: dict[str, Any] = {"hold": 0.0, **parameters}
    for port, b in zip(element.ports, bodies, strict=True):
        for axis in port.axes:
            known |= {
                port.coordinate(axis).name: v[f"{axis.name}_{b}"],
                port.rate(axis).name: v[f"{axis.name}_{b}'"],
            }
    forces = function(*(known[symbol.name] for symbol in element.arguments))
    return [np.broadcast_to(np.asarray(force, dtype=np.float64), (STATES,)) for force in forces]


def spring_parameters(v: Values, b: str) -> dict[str, Any]:
    """Collect a mesh's parameters on the printed flank; its position angle is turned by Delta_gamma."""
    m, (_, sigma) = f"P{b}", KIND[b]
    start = v[f"gamma_{m}"] - v[f"Delta_gamma_{m}"]
    alpha0 = np.arccos((v[f"r_{b}b"] + sigma * v["r_Pb"]) / v[f"d_{m}0"])
    return {
        "r_1": v[f"r_{b}b"], "r_2": v["r_Pb"], "d_0": v[f"d_{m}0"], "k": v[f"k_{m}"], "s": 1.0,
        "e_x": np.cos(start), "e_y": np.sin(start), "Delta_gamma_0": 0.0, "inv_0": np.tan(alpha0) - alpha0,
    }  # fmt: skip


def interactions(v: Values) -> Iterator[tuple[str, str, str, dict[str, Any]]]:
    """List (term group, element, bodies, parameters) of the planetary set."""
    for b in KIND:
        spring = spring_parameters(v, b)
        coulomb, viscous = {"mu": v[f"mu_P{b}"], "c_t": 0.0}, {"mu": 0.0, "c_t": v[f"c_P{b}"]}
        yield f"normal force {b}-P", f"mesh_{b}", f"{b}P", spring
        yield f"Coulomb friction {b}-P", f"friction_{b}", f"{b}P", spring | coulomb | {"v_0": 1e-12}
        yield f"viscous friction {b}-P", f"friction_{b}", f"{b}P", spring | viscous | {"v_0": 1.0}
        yield "bearing", "ground_bearing", b, {"k": v[f"k_{b}B"], "x_0": 0.0, "y_0": 0.0}
        yield "damping", "drag", b, {"c_t": v[f"c_{b}B"]}
    for b in "SRC":
        yield "external", "external_torque", b, {"T": v[f"T_{b}"]}
    for b in "SRPC":
        yield (
            "weight",
            "gravity",
            b,
            {"m": v[f"M_{b}"], "g_x": 0.0, "g_y": v[f"G_{b}"] / v[f"M_{b}"], "beta": 0.0},
        )
    arm = (v["R_P"] * np.cos(v["gamma_CP0"]), v["R_P"] * np.sin(v["gamma_CP0"]))
    spot = {"k": v["k_CPB"], "x_0": arm[0], "y_0": arm[1]}
    slip = spot | {"d_b": v["d_CPB"], "omega_0": 1e-12, "F_0": 1e-12}
    yield "pin", "pin", "CP", spot
    yield "damping", "pin_friction", "CP", slip | {"mu": 0.0, "c_r": v["c_PB"]}
    yield "bearing Coulomb friction", "pin_friction", "CP", slip | {"mu": v["mu_CPB"], "c_r": 0.0}


def derive_balances(v: Values) -> dict[str, Groups]:
    """Assemble the rows: label -> term group -> left side of Newton's laws."""
    rows: dict[str, Groups] = {f"{c}_{b}": {} for b in "SRPC" for c in COMPONENTS}
    for b in "SRPC":
        for c in COMPONENTS:
            rows[f"{c}_{b}"]["inertia"] = v[f"{'I' if c == 'theta' else 'M'}_{b}"] * v[f"{c}_{b}''"]
            if c != "theta" and b != "P":
                rows[f"{c}_{b}"]["external"] = -v[f"F_{b}{c}"]
    for group, name, bodies, parameters in interactions(v):
        forces = iter(wrench(name, bodies, v, parameters))
        for b in bodies:
            for c in COMPONENTS:
                force = next(forces)
                if np.any(force):
                    rows[f"{c}_{b}"][group] = rows[f"{c}_{b}"].get(group, 0.0) - force
    return rows


def derive_laws(v: Values, balances: Mapping[str, Groups]) -> dict[str, Groups]:
    """Derive the quantities defined by eqs 1 to 30: label -> term group -> value."""
    laws = derive_counts(v)
    for b in KIND:
        laws |= derive_rolling(v, b) | derive_triangle(v, b) | derive_friction(v, b, balances)
        for c in "xy":
            group = f"normal force {b}-P"
            laws[f"N_{b}P{c}"] = {group: -balances[f"{c}_P"][group]}
    for c in "xy":
        laws[f"delta_CP{c}"] = {"deflection": balances[f"{c}_P"]["pin"] / v["k_CPB"]}
        laws[f"F_CP{c}"] = {"pin": -balances[f"{c}_P"]["pin"]}
    coulomb, viscous = (-balances["theta_P"][group] for group in ("bearing Coulomb friction", "damping"))
    laws["T_CPz"] = {"Coulomb friction C-P": coulomb, "viscous friction C-P": viscous}
    return laws


def derive_counts(v: Values) -> dict[str, Groups]:
    """Derive counts: degrees of freedom in the plane, phases by positions of teeth, pairs in contact.

    A pair touches for epsilon pitches, and the next one starts a pitch later. Where single contact begins, a pair has
    just separated, and the remaining pair has touched for epsilon - 1 pitches; after one pitch of contact, the next
    pair touches.
    """
    points = np.random.default_rng(1).normal(size=(4, 2))
    arms = [(a, b) for a in range(4) for b in range(a)]
    rigid = np.zeros((len(arms), 8))
    for k, (a, b) in enumerate(arms):  # a body keeps the distances of its points
        rigid[k, 2 * a : 2 * a + 2], rigid[k, 2 * b : 2 * b + 2] = points[a] - points[b], points[b] - points[a]
    freedoms = 8 - np.linalg.matrix_rank(rigid)
    tooth, apart = 2 * np.pi / v["Z_S"], 2 * np.pi / v["n"]
    found: dict[str, Groups] = {"coordinates": {"number": freedoms * (3 + v["n"])}}
    found |= {"phi_i": {"phase": v["phi_i"]}, "phi_S0": {"phase": np.mod(apart, tooth)}}
    for label, late in (("k_PS", np.zeros(STATES)), ("k_PS,i", (v["i"] - 1) * apart)):
        touched = np.mod((v["theta"] - late) / v["theta_T"], 1.0) + v["epsilon"] - 1
        found[label] = {"stiffness": np.where(touched < 1, 1.0, v["xi"]) * v["k"]}
    return found


def derive_rolling(v: Values, b: str) -> dict[str, Groups]:
    """Derive angles and deflections of a mesh from the involute's force, which vanishes where the gears just touch."""
    m, parameters = f"P{b}", spring_parameters(v, b)
    at_hand = parameters | {"inv_0": np.tan(v[f"alpha_{m}"]) - v[f"alpha_{m}"]}  # no change of centre distance

    def force(values: Values, given: Mapping[str, Any]) -> Array:
        return -wrench(f"involute_{b}", f"{b}P", values, given)[2] / v[f"r_{b}b"]

    whole, rolled = force(v, parameters), force(v, at_hand)
    ahead = rolled / (force({**v, "theta_P": v["theta_P"] + 1.0}, at_hand) - rolled)
    return {
        f"rolling_{b}": {"deflection": v["Z_P"] * ahead},
        f"theta_P,{m}": {"ideal": v["theta_P"] - ahead},
        f"Delta_theta_{m}": {"difference": ahead},
        f"delta_theta_n,{m}": {"deflection": rolled / v[f"k_{m}"]},
        f"delta_dn,{m}": {"deflection": (whole - rolled) / v[f"k_{m}"]},
        f"delta_n,{m}": {"deflection": whole / v[f"k_{m}"]},
        f"N_{b}P": {"deflection": whole},
    }


def derive_triangle(v: Values, b: str) -> dict[str, Groups]:
    """Derive the triangle of a mesh from the direction of its normal force, at a right angle to the base radii."""
    m, (_, sigma) = f"P{b}", KIND[b]
    fx, fy = wrench(f"involute_{b}", f"{b}P", v, spring_parameters(v, b))[3:5]
    dx, dy = v["x_P"] - v[f"x_{b}"], v["y_P"] - v[f"y_{b}"]
    alpha = np.arctan2(sigma * (fx * dx + fy * dy), fy * dx - fx * dy)
    return {
        f"gamma_{m}": {"angle": np.arctan2(fy, fx) - np.pi / 2 + sigma * alpha},
        f"alpha_{m}": {"pressure": alpha},
        f"d_{m}": {"length": (v[f"r_{b}b"] + sigma * v["r_Pb"]) / np.cos(alpha)},
        f"r_P,{m}": {"length": v["r_Pb"] / np.cos(alpha)},
    }


def derive_friction(v: Values, b: str, balances: Mapping[str, Groups]) -> dict[str, Groups]:
    """Derive tangential friction, and the tangent deflection whose rate it opposes.

    The tangent is that of eq 15 and, for the ring, that along which rows 34 to 36 print friction; against it the
    deflection is positive.
    """
    m, (_, sigma) = f"P{b}", KIND[b]
    along = v[f"gamma_{m}"] - sigma * v[f"alpha_{m}"]
    force = {
        kind: tuple(-balances[f"{c}_P"][f"{kind} friction {b}-P"] for c in "xy") for kind in ("Coulomb", "viscous")
    }
    on = {kind: fx * np.cos(along) + fy * np.sin(along) for kind, (fx, fy) in force.items()}
    rate = on["viscous"] / v[f"c_{m}"]  # of the deflection; it is -d' cos(alpha), d cos(alpha) a constant
    length = (v[f"r_{b}b"] + sigma * v["r_Pb"]) * np.log(v[f"d_{m}"] / v[f"d_{m}0"])
    fx, fy = (part * v[f"sgn(delta_t_{m}')"] for part in force["Coulomb"])
    return {
        f"f_{b}P": {f"{kind} friction {b}-P": part for kind, part in on.items()},
        f"delta_t_{m}": {"deflection": rate / (v[f"d_{m}'"] * np.cos(v[f"alpha_{m}"])) * length},
        f"beta_{b}Pf": {"angle": np.arctan2(fy, fx)},
    }


@dataclass(frozen=True)
class DerivedRows:
    """States of one size, and every row derived at them."""

    values: Values
    rows: Mapping[str, Groups]


@lru_cache
def benches(sun: int, ring: int) -> tuple[DerivedRows, ...]:
    """Make the test states of all sizes for given directions (see ``random_values``)."""
    made = []
    for size in SIZES:
        values = random_values(size, {"S": sun, "R": ring})
        balances = derive_balances(values)
        made.append(DerivedRows(values, balances | derive_laws(values, balances)))
    return tuple(made)
