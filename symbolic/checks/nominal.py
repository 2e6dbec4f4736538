"""Nominal model: gears at their nominal positions without errors, for checks of the paper's law."""

from collections.abc import Iterator
from dataclasses import replace

from ..mechanics.model import Body, Instance, Model


def at_nominal(model: Model) -> Model:
    """Return the model without pin position errors, eccentricities and tooth errors.

    The structure stays; only numbers change.
    """
    values = model.values()
    units = {q.name: q.unit for q in model.parameters}
    changed = {
        name: 0.0
        for profile in model.profiles
        if profile.quantity == "error"
        for name in profile.numbers
        if units[name] == "m"
    }
    for instance in model.instances:
        if "d_0" in instance.bind:
            changed |= _places(model, instance, values)
    parameters = tuple(replace(q, value=changed.get(q.name, q.value)) for q in model.parameters)
    return replace(model, parameters=parameters)


def _places(model: Model, instance: Instance, values: dict[str, float]) -> dict[str, float]:
    """Return the positions of the bodies of a mesh: gear 2 at the centre distance, tooth centres on the axes."""
    bodies = {body.name: body for body in model.bodies}
    one, two = ([*_down(bodies, name)] for name in instance.bodies)
    distance = values[instance.bind["d_0"]]
    found = {name: 0.0 for body in (*one[:-1], *two[:-1]) for name in body.place or ()}
    if two[-1].place is not None:
        x, y = two[-1].place
        found |= {x: distance * values[instance.bind["e_x"]], y: distance * values[instance.bind["e_y"]]}
    return found


def _down(bodies: dict[str, Body], name: str) -> Iterator[Body]:
    """Yield a body and, if it is a tooth centre, its gear."""
    body = bodies[name]
    yield body
    if body.turning == "point" and body.seat is not None:
        yield from _down(bodies, body.seat)
