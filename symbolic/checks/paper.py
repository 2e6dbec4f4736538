r"""Check: each printed equation of Wu et al. 2021 against the same row put together from element wrenches.

Rows are compared term group by term group at seeded random states on the printed flank (s = +1, N > 0),
while the planets roll at the pitch points: the only motion that the paper's tangent deformation (eqs 8
and 24) knows of. Of the two directions of sliding, the explicit rows 32 and 34-37 print one without saying
which; per mesh, the one with which more printed Coulomb terms agree is taken (``direction``). Friction
opposes sliding. Rows 14 and 27 carry their own sgn() and are compared in both directions at once.

``agrees`` means equal to rounding; ``first-order``, that the relative difference vanishes with the change
of centre distance and the tooth deflection; ``misprint``, neither. A misprint is explained by the fewest
edits (a sign, an index, a radius, a sine, ...) that turn the printed group into the derived one.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache
from itertools import combinations
from typing import Any

import numpy as np
import sympy as sp
from numpy.typing import NDArray

from ..elements.base import Element
from ..elements.bearing import ground_bearing, pin, pin_friction
from ..elements.gravity import gravity
from ..elements.mesh import mesh
from ..elements.mesh_friction import mesh_friction
from ..elements.torsion import drag, external_torque
from ..paper import EXACT, MEANING, ROWS, Edit, Row, edits, evaluate, text

Array = NDArray[np.float64]
Values = Mapping[str, Array]
Groups = dict[str, Array]

STATES, TOLERANCE = 20, 1e-9
SIZES = (1e-2, 1e-4)
KIND = {"S": ("external", 1), "R": ("internal", -1)}
COMPONENTS = ("x", "y", "theta")
SEVERITY = ("agrees", "first-order", "misprint")
MAX_EDITS = 5


@dataclass(frozen=True)
class Verdict:
    """What the comparison says of one printed row; ``printed`` and ``derived`` are plain text."""

    equation: int
    row: str
    verdict: str
    why: str
    printed: str
    derived: str


# --- random states


def random_values(size: float, directions: Mapping[str, int]) -> dict[str, Array]:
    """Draw states as name -> values, shape (20,).

    Parameters
    ----------
    size
        Relative size of the centre distance's change and of the tooth deflection.
    directions
        Mesh (S or R) -> +1 where the centres approach, -1 where they part, 0 for some of each.
    """
    rng = np.random.default_rng(31)

    def draw(low: float = 0.5, high: float = 1.5) -> Array:
        return rng.uniform(low, high, STATES)

    plain = "M_S M_R M_P M_C I_S I_R I_P I_C k_SB k_RB k_CPB c_SB c_RB c_PB R_P mu_CPB d_CPB"
    signed = "F_Sx F_Sy T_S F_Rx F_Ry T_R F_Cx F_Cy T_C G_S G_R G_P G_C gamma_CP0"
    v = {name: draw() for name in plain.split()}
    v |= {name: draw(-2.0, 2.0) for name in signed.split()}
    for rate in ("", "'", "''"):
        v |= {f"{c}_{b}{rate}": draw(-2.0, 2.0) for c in COMPONENTS for b in "SRPC"}
    v |= {"r_Pb": draw(), "r_Sb": draw(0.5, 2.0), "r_Rb": draw(3.0, 5.0)}
    pitch = draw(10.0, 20.0)
    v |= {f"Z_{b}": v[f"r_{b}b"] * pitch for b in "SRP"}
    v["theta_C + gamma_CP0"] = v["theta_C"] + v["gamma_CP0"]
    for b, (_, sigma) in KIND.items():
        place_gear(v, b, sigma, size, directions[b], draw)
        name_components(v, b, sigma)
    return v | phase_values(rng)


def place_gear(
    v: dict[str, Array], b: str, sigma: int, size: float, direction: int, draw: Callable[..., Array]
) -> None:
    """Place sun or ring against the planet: nearly at its centre distance, loaded, rolling."""
    m, base, planet = f"P{b}", v[f"r_{b}b"], v["r_Pb"]
    c = base + sigma * planet
    d0 = c / np.cos(draw(0.3, 0.45))
    d, gamma, turn = d0 * (1 + size * draw(-1.0, 1.0)), draw(-3.0, 3.0), draw(-0.4, 0.4)
    cos, sin, alpha = np.cos(gamma), np.sin(gamma), np.arccos(c / d)
    sign = -float(direction) if direction else np.where(np.arange(STATES) % 2, 1.0, -1.0)
    rate, swing = sign * draw(), draw(-1.0, 1.0)
    v[f"x_{b}"], v[f"y_{b}"] = v["x_P"] - d * cos, v["y_P"] - d * sin
    v[f"x_{b}'"] = v["x_P'"] - rate * cos + swing * d * sin
    v[f"y_{b}'"] = v["y_P'"] - rate * sin - swing * d * cos
    v[f"theta_{b}'"] = swing - sigma * planet * (v["theta_P'"] - swing) / base
    roll = size * planet * draw(5.0, 10.0)
    v[f"theta_{b}"] = turn + (roll - sigma * planet * (v["theta_P"] - turn)) / base
    v |= {f"d_{m}": d, f"d_{m}0": d0, f"d_{m}'": rate, f"alpha_{m}": alpha, f"Delta_gamma_{m}": turn}
    v |= {f"gamma_{m}": gamma, f"mu_{m}": draw(0.05, 0.2), f"c_{m}": draw(), f"k_{m}": draw(50.0, 90.0)}
    v[f"gamma_{b}P - alpha_{b}P"] = gamma - alpha
    v[f"alpha_{b}P - gamma_{b}P"] = alpha - gamma
    v[f"gamma_{b}P + alpha_{b}P"] = gamma + alpha
    v[f"N_{m}"] = -sigma * v[f"k_{m}"] * ((d - d0) * np.sin(alpha) - sigma * planet * np.tan(roll / planet))
    v[f"delta_t_{m}'"] = -d0 * c / d**2 * rate
    v[f"sgn(delta_t_{m}')"] = np.sign(v[f"delta_t_{m}'"])


def name_components(v: dict[str, Array], b: str, sigma: int) -> None:
    """Resolve what rows 31 and 33 only name: forces on sun or ring along eqs 13, 15, 26, 28.

    Torques are moments of these forces at the pitch point; friction has the size and the direction that
    the derivation gives it, so that these rows are judged by their signs and arms.
    """
    m = f"P{b}"
    along = v[f"gamma_{m}"] - sigma * v[f"alpha_{m}"]
    arm = v[f"d_{m}"] * v[f"r_{b}b"] / (v[f"r_{b}b"] + sigma * v["r_Pb"])
    ax, ay = arm * np.cos(v[f"gamma_{m}"]), arm * np.sin(v[f"gamma_{m}"])
    slide = v[f"d_{m}'"]
    friction = -v[f"mu_{m}"] * v[f"N_{m}"] * np.sign(slide) - v[f"c_{m}"] * slide * np.cos(v[f"alpha_{m}"])
    for name, size, beta in (("N", v[f"N_{m}"], np.pi / 2 + along), ("f", friction, along)):
        fx, fy = -size * np.cos(beta), -size * np.sin(beta)
        v |= {f"{name}_{m}x": fx, f"{name}_{m}y": fy, f"T_{m}{name}": ax * fy - ay * fx}


def phase_values(rng: np.random.Generator) -> dict[str, Array]:
    """Draw planet counters short of a whole tooth, and the phase that their place round the sun gives."""
    n = rng.integers(3, 7, STATES)
    rest = rng.integers(1, n)
    teeth = n * rng.integers(5, 20, STATES) + rest
    i = 1 + rng.integers(0, (n - 1) // rest + 1)
    pitch = 2 * np.pi / teeth
    phase = (i - 1) * teeth % n / n * pitch
    values = {"n": n, "i": i, "phi_S0": (teeth / n - teeth // n) * pitch, "phi_i": phase}
    return {name: np.asarray(value, dtype=np.float64) for name, value in values.items()}


# --- derived rows

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
    return element, sp.lambdify(element.arguments, list(element.wrench), modules, cse=True)


def wrench(name: str, bodies: str, v: Values, parameters: Mapping[str, Any]) -> list[Array]:
    """Evaluate an element between bodies (``"SP"``: sun, then planet)."""
    element, function = compiled(name)
    known: dict[str, Any] = {"hold": 0.0, **parameters}
    for port, b in zip(element.ports, bodies, strict=True):
        names = [f"{c}_{b}{rate}" for rate in ("", "'") for c in COMPONENTS]
        known |= {s.name: v[n] for s, n in zip((*port.coordinates, *port.rates), names, strict=True)}
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
    """Put the rows together: label -> term group -> what Newton's laws give left of the equals sign."""
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
    """Derive what the defining equations define: forces on the planet, deflections, phases."""
    laws: dict[str, Groups] = {"phi_i": {"phase": v["phi_i"]}}
    for b, (_, sigma) in KIND.items():
        parameters = spring_parameters(v, b)
        force = wrench(f"involute_{b}", f"{b}P", v, parameters)
        laws[f"N_{b}P"] = {"deflection": -force[2] / v[f"r_{b}b"]}
        along = v[f"gamma_P{b}"] - sigma * v[f"alpha_P{b}"] + (np.pi if b == "R" else 0.0)
        laws[f"f_{b}P"] = {}
        for kind in ("Coulomb", "viscous"):
            group = f"{kind} friction {b}-P"
            fx, fy = -balances["x_P"][group], -balances["y_P"][group]
            laws[f"f_{b}P"][group] = fx * np.cos(along) + fy * np.sin(along)
        for c in "xy":
            group = f"normal force {b}-P"
            laws[f"N_{b}P{c}"] = {group: -balances[f"{c}_P"][group]}
    for c in "xy":
        laws[f"delta_CP{c}"] = {"deflection": balances[f"{c}_P"]["pin"] / v["k_CPB"]}
    return laws


@dataclass(frozen=True)
class Bench:
    """States of one size, and every row derived at them."""

    values: Values
    rows: Mapping[str, Groups]


@lru_cache
def benches(sun: int, ring: int) -> tuple[Bench, ...]:
    """Make the test states of all sizes for given directions (see ``random_values``)."""
    made = []
    for size in SIZES:
        values = random_values(size, {"S": sun, "R": ring})
        balances = derive_balances(values)
        made.append(Bench(values, balances | derive_laws(values, balances)))
    return tuple(made)


# --- comparison


def target(row: Row, group: str, bench: Bench) -> Array:
    """Return the derived term group; rows 31 and 33 name both kinds of friction as one force."""
    groups = bench.rows[row.label]
    if group.startswith("friction"):
        return groups[f"Coulomb {group}"] + groups[f"viscous {group}"]
    return groups.get(group, np.zeros(STATES))


def grade(row: Row, group: str, expression: sp.Expr, where: Sequence[Bench]) -> str:
    """Compare one group: agrees, first-order or misprint."""
    errors = []
    for bench in where:
        right = target(row, group, bench)
        wrong = np.max(np.abs(evaluate(expression, bench.values) - right))
        errors.append(float(wrong / np.max(np.abs(right))) if np.any(right) else float(wrong > 0) * np.inf)
    if max(errors) < TOLERANCE:
        return "agrees"
    shrinks = errors[-1] < 3 * errors[0] * SIZES[-1] / SIZES[0]
    return "first-order" if shrinks and errors[0] < 1 else "misprint"


def bench_for(row: Row) -> tuple[Bench, ...]:
    """Choose the states of a row: both directions at once where the row carries its own sgn()."""
    return benches(0, 0) if row.label in ("f_SP", "f_RP") else benches(direction("S"), direction("R"))


@lru_cache
def direction(b: str) -> int:
    """Deduce the direction of sliding that the explicit rows print: +1 where the centres approach."""
    group = f"Coulomb friction {b}-P"
    rows = [row for row in ROWS if group in row.terms and not row.definition]
    score = {
        way: sum(grade(row, group, row.terms[group], benches(way, way)) != "misprint" for row in rows)
        for way in (1, -1)
    }
    return max(score, key=lambda way: score[way])


# --- explanation


def repair(row: Row, group: str, where: Sequence[Bench]) -> tuple[sp.Expr, tuple[Edit, ...]] | None:
    """Find the fewest edits that make a printed group the derived one, if there are any."""
    printed = row.terms[group]
    single = edits(printed)
    for count in range(1, MAX_EDITS + 1):
        for chosen in combinations(single, count):
            if len({edit.slot for edit in chosen}) < count:
                continue
            expression = printed
            for edit in chosen:
                expression = edit.apply(expression)
            if grade(row, group, expression, where) != "misprint":
                return expression, chosen
    return None


def ratio(row: Row, group: str, bench: Bench) -> str:
    """Say by what factor a group without a known repair differs."""
    factors = evaluate(row.terms[group], bench.values) / target(row, group, bench)
    return f"{group}: no simple repair; printed / derived lies between {min(factors):.3g} and {max(factors):.3g}"


def explain(row: Row, group: str, where: Sequence[Bench]) -> tuple[sp.Expr, str]:
    """Return the derived form of a group that differs, and the reason in words."""
    if not np.any(target(row, group, where[0])):
        return sp.S.Zero, f"{group}: printed, but the derivation has none"
    if (found := repair(row, group, where)) is None:
        return sp.Symbol(f"<{group}>"), ratio(row, group, where[0])
    expression, chosen = found
    meanings = [MEANING.get((group.split()[0], edit.slot), "") for edit in chosen]
    why = f"{group}: prints " + ", ".join(edit.reads for edit in chosen)
    return expression, why + "".join(f"; {meaning}" for meaning in dict.fromkeys(meanings) if meaning)


def left_out(row: Row, where: Sequence[Bench]) -> dict[str, sp.Expr]:
    """Return the derived groups that a row does not print, as a symbol where one names them."""
    named = {f"friction {b}-P" for b in KIND} & set(row.terms)
    missing = [g for g in where[0].rows[row.label] if g not in row.terms and not any(n in g for n in named)]
    found = {}
    for group in missing:
        right = where[0].rows[row.label][group]
        same = (name for name, value in where[0].values.items() if np.allclose(-value, right, rtol=TOLERANCE))
        found[group] = -sp.Symbol(next(same, f"<{group}>"))
    return found


def check_row(row: Row) -> Verdict:
    """Compare one row with the derivation; its verdict is the worst of its groups'."""
    return judge_row(row)[0]


def judge_row(row: Row) -> tuple[Verdict, dict[str, sp.Expr]]:
    """Compare one row with the derivation; beside the verdict, return the derived term groups."""
    where = bench_for(row)
    worst, reasons, derived = "agrees", [], dict(row.terms)
    for group, expression in row.terms.items():
        verdict = grade(row, group, expression, where)
        worst = max(worst, verdict, key=SEVERITY.index)
        if verdict == "misprint":
            derived[group], why = explain(row, group, where)
            reasons.append(why)
        elif verdict == "first-order":
            reasons.append(f"{group}: right to first order in the change of centre distance and deflection")
            if row.label in EXACT and grade(row, group, EXACT[row.label], where) == "agrees":
                derived[group] = EXACT[row.label]
    for group, expression in left_out(row, where).items():
        worst = "misprint"
        derived[group] = expression
        hint = MEANING.get((group.split()[0], "left out"), "")
        reasons.append(f"{group}: left out" + f" ({hint})" * bool(hint))
    defined = row.label if row.definition else ""
    told = Verdict(row.equation, row.label, worst, "; ".join(reasons), row.printed, text(derived, defined))
    return told, derived


def check_paper(rows: Sequence[Row] | None = None) -> tuple[Verdict, ...]:
    """Compare printed rows (all by default) with the derivation and explain what differs."""
    return tuple(check_row(row) for row in (ROWS if rows is None else rows))
