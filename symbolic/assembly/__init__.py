"""Assembly of the model: bodies and elements for the scene's effects (Scene -> Model)."""

from math import cos, sin

from ltcgear.generated.contract import GEOMETRY

from ..gears import gear_geometry, train
from ..gears.train_members import planet_angles
from ..mechanics.model import Model
from ..scene.validate import meshes
from ..schema.scene_schema import Pair, Planetary, Scene
from .bodies import add_body, add_coupling, add_gravity, add_member, add_pin
from .draft import Draft, MeshPlace
from .gearing import add_mesh
from .loading import add_load, add_reference
from .rayleigh_damping import add_rayleigh
from .rigid import find_leaders, in_plane, pin_places, rigid_pins


def build_model(scene: Scene) -> Model:
    """Assemble the model of a scene.

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
    draft = Draft(scene, rigid, train.static_forces(scene, rigid), leaders=find_leaders(scene, rigid))
    add_reference(draft)
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
        add_load(draft, name, load)
    if draft.on("gravity"):
        add_gravity(draft)
    add_rayleigh(draft)
    return Model(
        scene.title, scene.name, rigid.mode, tuple(draft.bodies), draft.frames, draft.placed(),
        tuple(draft.levels), tuple(draft.phases), tuple(draft.profiles),
        tuple(draft.parameters.values()), dict(scene.effects), draft.statics,
        tuple(draft.signals.values()), draft.tables, tuple(draft.clocks),
    )  # fmt: skip


def _planetary(draft: Draft, name: str, stage: Planetary) -> None:
    """Add a planetary stage in the frame that rotates with its carrier."""
    turns = stage.carrier.support != "fixed" and draft.rigid.ratios[f"{name}.carrier"] != 0.0
    draft.frames[name] = f"{name}.carrier.speed_ratio" if turns else None
    for part in ("carrier", "ring", "sun"):
        add_member(draft, f"{name}.{part}", getattr(stage, part), name)
    distance, carrier = gear_geometry.stage_distance(stage), f"{name}.carrier"
    angles = planet_angles(stage)
    pins = zip(angles, pin_places(draft.scene, stage), strict=True)
    for i, (angle, pin) in enumerate(pins, start=1):
        planet = f"{name}.planet.{i}"
        direction = stage.line_of_centres + angle
        if rigid_pins(draft.scene):
            place = _place(draft, planet, *pin) if in_plane(draft.scene) else None
            add_body(draft, planet, f"{name}.planet", stage.planet, False, name, place, carrier if place else None)
        else:
            place = _place(draft, planet, distance * cos(direction), distance * sin(direction))
            add_body(draft, planet, f"{name}.planet", stage.planet, True, name, place)
            misplaced = draft.on("planet_position_error") and stage.position_errors
            add_pin(draft, name, i, stage, _place(draft, f"{name}.pin.{i}", *pin) if misplaced else place)
        for mesh_name, mesh, one, two, sigma in meshes(stage):
            key, members = f"{name}.{mesh_name}", (f"{name}.{mesh_name.split('_')[0]}", planet)
            ahead = angle - angles[0]
            add_mesh(draft, MeshPlace(key, f"{key}.{i}", stage, mesh, (one, two), sigma, members, direction, ahead))


def _place(draft: Draft, name: str, x: float, y: float) -> tuple[str, str]:
    """Register a position [m] and return its parameters."""
    return draft.number(f"{name}.x_0", x, "m", GEOMETRY), draft.number(f"{name}.y_0", y, "m", GEOMETRY)


def _pair(draft: Draft, name: str, stage: Pair) -> None:
    """Add a parallel pair; the output stands at the centre distance from the input."""
    distance, direction = gear_geometry.stage_distance(stage), stage.line_of_centres
    draft.frames[name] = None
    output = f"{name}.output"
    add_member(draft, f"{name}.input", stage.input, name)
    plane = in_plane(draft.scene)
    place = _place(draft, output, distance * cos(direction), distance * sin(direction)) if plane else None
    add_member(draft, output, stage.output, name, place)
    key, wheels, members = f"{name}.mesh", (stage.input, stage.output), (f"{name}.input", output)
    add_mesh(draft, MeshPlace(key, key, stage, stage.mesh, wheels, 1, members, direction))
