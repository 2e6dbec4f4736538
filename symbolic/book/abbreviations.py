"""Abbreviations: intermediate quantities of an element's law, in computing order.

They come from the same functions as the elements, so they occur literally in the elements' expressions; those that do
not occur are left out.
"""

from collections.abc import Callable, Iterator

import sympy as sp

from ..elements.base import Element, real
from ..elements.bearing import CARRIER, EPS, PLANET, X0, Y0, K, pin_deflection, pin_place, pin_speed
from ..elements.clearance import Race
from ..elements.contact import Rest, Switch
from ..elements.key import ElementKey
from ..elements.mesh import ERROR, ERROR_RATE, GAP, ONE, TWO, Geometry, S, approach, deflection, geometry, torsional_law
from ..elements.mesh_friction import sliding_speed
from ..elements.tooth_pairs import PHASE, SHARE, Wrapped, tooth_pairs
from ..elements.torsion import OMEGA_B, OMEGA_S
from .folding import NamedStep


def list_steps(key: ElementKey, element: Element) -> list[NamedStep]:
    """Return the named quantities of an element type, each in its raw form, simple ones first.

    Parameters
    ----------
    key, element
        Element type as in ``Instance.element``, and the element that it makes.
    """
    writer = _OF.get(key.type)
    return [] if writer is None else list(writer(key, element))


def _named(name: str, raw: sp.Expr) -> NamedStep:
    """Name a quantity; nonnegative quantities are declared so, so that sqrt(x^2) = x."""
    value = sp.sympify(raw)
    if value.is_nonnegative:
        return NamedStep(sp.Symbol(name, nonnegative=True), value)
    return NamedStep(real(name), value)


def _length(name: str, raw: sp.Expr) -> Iterator[NamedStep]:
    """Name a length and its square."""
    step = _named(name, raw)
    yield step
    yield NamedStep(step.symbol**2, raw**2)


def _triangle(g: Geometry) -> Iterator[NamedStep]:
    """Name the sides and angles of a mesh's triangle."""
    yield _named("Delta_x", g.dx)
    yield _named("Delta_y", g.dy)
    yield from _length("d", g.d)
    yield _named("r_sum", g.c)
    yield _named("h", g.h)
    yield _named("alpha_w", g.alpha)
    yield _named("Delta_gamma", g.turned)


def _directions(pairs: tuple[tuple[str, tuple[sp.Expr, sp.Expr]], ...]) -> Iterator[NamedStep]:
    """Name the components of unit vectors."""
    for name, (x, y) in pairs:
        yield _named(f"{name}_x", x)
        yield _named(f"{name}_y", y)


def _mesh(key: ElementKey, element: Element) -> Iterator[NamedStep]:
    """Name the quantities of a mesh."""
    kind, law, contact, error = (key[option] for option in ("kind", "law", "contact", "error"))
    plane = law in ("involute", "paper")
    if plane:
        g = geometry(str(kind))
        yield from _triangle(g)
        yield _named("w", g.w)
        yield _named("psi", ONE.theta - g.turned)
        yield from _directions((("n", g.normal),))
        delta, rate = deflection(str(kind), str(law)), approach(str(kind))
    else:
        written = torsional_law(str(kind), law == "orbiting")
        delta, rate = written.deflection, written.rate
    delta, rate = _without(delta, contact, error), rate - (ERROR_RATE if error else 0)
    yield _named("delta", delta)
    yield _named("delta_d", rate)
    yield from _contact(element)
    yield _named("N", element.outputs["force"].expression)


def _without(delta: sp.Expr, contact: str | bool, error: str | bool) -> sp.Expr:
    """Subtract gap and error from a deflection."""
    return delta - (GAP if contact == "gap" else 0) - (ERROR if error else 0)


def _contact(element: Element) -> Iterator[NamedStep]:
    """Name the border of contact and its sides, where an element has them."""
    found = {kind: [e for w in element.loads for e in w.atoms(kind)] for kind in (Switch, Rest)}
    for switch in found[Switch][:1]:
        yield _named("g_b", switch.args[0])
        yield _named("chi", switch)
    for rest in found[Rest][:1]:
        yield _named("chi_0", rest)


def _friction(key: ElementKey, element: Element) -> Iterator[NamedStep]:
    """Name the quantities of friction at the pitch point."""
    yield from _rubbed(key, element)
    yield _named("F", element.outputs["friction"].expression)


def _rubbed(key: ElementKey, element: Element) -> Iterator[NamedStep]:
    """Name the normal force and sliding speed of a mesh with friction."""
    kind, law, contact, error = (key[option] for option in ("kind", "law", "contact", "error"))
    g = geometry(str(kind))
    yield from _triangle(g)
    yield _named("w", g.w)
    yield from _directions((("m", g.along),))
    yield _named("delta", _without(deflection(str(kind), str(law)), contact, error))
    yield from _contact(element)
    yield _named("v_t", sliding_speed(str(kind)))


def _sliding(key: ElementKey, element: Element) -> Iterator[NamedStep]:
    """Name the quantities of sliding friction."""
    yield from _rubbed(key, element)
    yield _named("g", Wrapped(PHASE - SHARE / 2))
    for letter, (place, part) in zip("AB", tooth_pairs(), strict=True):
        if letter == "A":
            yield _named("w_A", part)
        yield _named(f"xi_{letter}", place)
        yield _named(f"v_{letter}", sliding_speed(str(key["kind"])) - S * place * (TWO.omega - ONE.omega))
    yield _named("F", element.outputs["friction"].expression)


def _pin(key: ElementKey, element: Element) -> Iterator[NamedStep]:
    """Name the quantities of a planet bearing, clearance included."""
    yield from _directions((("a", pin_place()), ("u", pin_deflection())))
    yield _named("Delta_x", PLANET.x - CARRIER.x)
    yield _named("Delta_y", PLANET.y - CARRIER.y)
    yield from _directions((("w", pin_speed()),))
    if "clearance" in key.type:
        yield from _race(Race(*pin_deflection()))


def _rubbing_pin(key: ElementKey, element: Element) -> Iterator[NamedStep]:
    """Name the quantities of a planet bearing's friction."""
    yield from _pin(key, element)
    ux, uy = pin_deflection()
    k = Race(ux, uy).secant if "clearance" in key.type else K
    yield _named("F_n", sp.sqrt((k * ux) ** 2 + (k * uy) ** 2 + EPS**2))
    yield _named("omega_r", PLANET.omega - CARRIER.omega)


def _race(race: Race) -> Iterator[NamedStep]:
    """Name the quantities of a bearing with clearance."""
    yield from _length("r_u", race.radius)
    yield _named("g_b", race.reach)
    yield _named("chi", race.touching)


def _ground_clearance(key: ElementKey, element: Element) -> Iterator[NamedStep]:
    """Name the quantities of a housing bearing with clearance."""
    body = element.ports[0]
    ux, uy = body.x - X0, body.y - Y0
    yield from _directions((("u", (ux, uy)),))
    yield from _race(Race(ux, uy))


def _slip(key: ElementKey, element: Element) -> Iterator[NamedStep]:
    """Name the slip."""
    yield _named("z", (element.ports[0].omega - OMEGA_S) / OMEGA_B)


_OF: dict[str, Callable[[ElementKey, Element], Iterator[NamedStep]]] = {
    "mesh": _mesh,
    "mesh_friction": _friction,
    "mesh_sliding": _sliding,
    "pin": _pin,
    "pin_friction": _rubbing_pin,
    "pin_clearance": _pin,
    "pin_clearance_friction": _rubbing_pin,
    "ground_clearance": _ground_clearance,
    "slip_torque": _slip,
}
