"""Degrees of freedom of a model, with the reason for each body."""

from collections.abc import Iterator

from ..gears.train_members import members
from ..mechanics.model import Body, Model
from ..schema.scene_schema import Member, Scene

Row = dict[str, str | list[str]]


def explain_freedoms(scene: Scene, model: Model) -> list[Row]:
    """Return the reason for each degree of freedom.

    Parameters
    ----------
    scene, model
        A scene and its model.

    Returns
    -------
    list of dict
        ``body`` (equal planets once, as ``lsp.planet.1-4``), its ``axes`` and the ``reason``; the angle of the
        rigid motion comes first where the train turns.
    """
    rows = [*_reference(scene, model)]
    for body in model.bodies:
        axes = list(body.freedoms)
        reasons = [*_shifts(scene, body), *_turns(model, body)]
        if axes:
            rows.append({"body": body.name, "axes": axes, "reason": "; ".join(reasons)})
    return _merged(rows)


def _reference(scene: Scene, model: Model) -> Iterator[Row]:
    """Explain the angle of the rigid motion."""
    if model.reference == "rest":
        return
    names = [body.name for body in model.bodies if body.turning == "reference"]
    if names:
        reason = f"rigid motion: no speed is held, so the train turns as {names[0]} does and its speed is a state"
        yield {"body": "reference", "axes": ["angle", "speed"], "reason": reason}
        return
    held = [f"loads.{name}" for name, load in scene.loads.items() if any(b.name == load.member for b in _driven(model))]
    yield {
        "body": "reference",
        "axes": ["angle"],
        "reason": f"rigid motion: the speed is held by {', '.join(held)}, the angle advances with it",
    }


def _driven(model: Model) -> list[Body]:
    """Return the bodies with prescribed speed."""
    return [body for body in model.bodies if body.turning == "driven"]


def _shifts(scene: Scene, body: Body) -> Iterator[str]:
    """Say why a body has lateral motion."""
    if not body.lateral:
        return
    member = members(scene).get(body.name)
    if not isinstance(member, Member):
        yield "x, y: its pin is flexible"
    elif member.bearing is not None:
        yield f"x, y: support = {member.support}, with a flexible bearing"
    else:
        yield f"x, y: support = {member.support}, nothing but its meshes and pins holds it"


def _turns(model: Model, body: Body) -> Iterator[str]:
    """Say which flexibility lets a body, with rigidly joined bodies, deviate from the rigid rotation."""
    if body.turning != "free":
        return
    joined = {body.name, *(other.name for other in model.bodies if other.leader == body.name)}
    touching = [i for i in model.instances if joined & set(i.bodies)]
    groups = {i.group for i in touching}
    flexible = ["its meshes are flexible"] * ("mesh" in groups)
    flexible += ["the pins on it are flexible"] * any(i.group == "pin" and i.bodies[0] in joined for i in touching)
    flexible += [f"shaft {i.name} is flexible" for i in touching if i.group == "coupling"]
    flexible += ["its torsional support is flexible"] * ("torsional_support" in groups)
    yield "u: " + (", ".join(flexible) or "nothing holds its angle")


def _merged(rows: list[Row]) -> list[Row]:
    """Write the equal planets of a stage as one row."""
    groups: dict[str, list[Row]] = {}
    for row in rows:
        stem, _, tail = str(row["body"]).rpartition(".")
        groups.setdefault(stem if tail.isdigit() else str(row["body"]), []).append(row)
    return [
        group[0] if len(group) == 1 else group[0] | {"body": f"{stem}.1-{len(group)}"} for stem, group in groups.items()
    ]
