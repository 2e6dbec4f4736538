"""Second stage: Scene -> Model, only with the elements that the scene's effects call for."""

from math import cos, pi, sin

from .. import gears, train
from ..model import Model
from ..schema import Pair, Planetary, Scene
from ..validate import meshes
from .bodies import add_body, add_coupling, add_gravity, add_member, add_pin, pin_place
from .draft import Draft
from .gearing import add_mesh
from .rayleigh import add_rayleigh


def build_model(scene: Scene) -> Model:
    """Put the model of a scene together.

    Parameters
    ----------
    scene
        A validated scene.

    Returns
    -------
    Model
        Bodies, element instances and parameters in a fixed order.
    """
    rigid, _ = train.motion(scene)
    draft = Draft(scene, rigid, train.static_forces(scene, rigid))
    if rigid.mode != "rest":
        draft.number("reference.speed", rigid.speed, "rad/s")
    for name, rotor in scene.rotors.items():
        add_member(draft, name, rotor, "")
    for name, stage in scene.stages.items():
        if isinstance(stage, Planetary):
            _planetary(draft, name, stage)
        else:
            _pair(draft, name, stage)
    for name, coupling in scene.couplings.items():
        add_coupling(draft, name, coupling)
    for name, load in scene.loads.items():
        if load.torque is not None:
            torque = draft.number(f"loads.{name}.torque", load.torque, "N*m")
            draft.place(f"loads.{name}", ("external_torque",), (load.member,), T=torque)
    if draft.on("gravity"):
        add_gravity(draft)
    add_rayleigh(draft)
    return Model(
        scene.title, scene.name, rigid.mode, tuple(draft.bodies), draft.frames, tuple(draft.instances),
        tuple(draft.levels), tuple(draft.phases), tuple(draft.rollings), tuple(draft.parameters.values()),
        dict(scene.effects), draft.statics,
    )  # fmt: skip


def _planetary(draft: Draft, name: str, stage: Planetary) -> None:
    """Add a planetary stage in the frame that turns with its carrier."""
    turns = stage.carrier.support != "fixed" and draft.rigid.ratios[f"{name}.carrier"] != 0.0
    for part in ("carrier", "ring", "sun"):
        add_member(draft, f"{name}.{part}", getattr(stage, part), name)
    draft.frames[name] = f"{name}.carrier.speed_ratio" if turns else None
    distance = gears.stage_distance(stage)
    angles = stage.planet_angles or [2 * pi * i / stage.planets for i in range(stage.planets)]
    for i, angle in enumerate(angles, start=1):
        planet = f"{name}.planet.{i}"
        direction = stage.line_of_centres + angle
        place = (
            draft.number(f"{planet}.x_0", distance * cos(direction), "m"),
            draft.number(f"{planet}.y_0", distance * sin(direction), "m"),
        )
        add_body(draft, planet, f"{name}.planet", stage.planet, True, name, place)
        add_pin(draft, name, i, stage, pin_place(draft, name, i, stage, direction) or place)
        for mesh_name, mesh, one, two, sigma in meshes(stage):
            gear = f"{name}.{mesh_name.split('_')[0]}"
            add_mesh(
                draft,
                f"{name}.{mesh_name}",
                f".{i}",
                stage,
                mesh,
                (gear, planet),
                (one, two),
                sigma,
                direction,
            )


def _pair(draft: Draft, name: str, stage: Pair) -> None:
    """Add a parallel pair; the output stands at the centre distance from the input."""
    distance, direction = gears.stage_distance(stage), stage.line_of_centres
    draft.frames[name] = None
    place = (
        draft.number(f"{name}.output.x_0", distance * cos(direction), "m"),
        draft.number(f"{name}.output.y_0", distance * sin(direction), "m"),
    )
    add_member(draft, f"{name}.input", stage.input, name)
    add_member(draft, f"{name}.output", stage.output, name, place)
    bodies = (f"{name}.input", f"{name}.output")
    add_mesh(draft, f"{name}.mesh", "", stage, stage.mesh, bodies, (stage.input, stage.output), 1, direction)
