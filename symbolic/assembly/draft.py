"""Draft of the model during assembly; the only mutable value of the pipeline."""

from dataclasses import dataclass, field, replace

from ltcgear.generated.contract import ANY, GEOMETRY, NOT_NEGATIVE, PHYSICAL, REGIME, Clock, Signal

from ..elements.axes import PLANE
from ..elements.key import ElementKey
from ..gears.train_members import RigidMotion
from ..mechanics.model import HOLD, Body, Instance, Level, Parameter, Phase, Profile
from ..schema.mesh_schema import Mesh
from ..schema.scene_schema import Gear, Pair, Planetary, Rayleigh, Scene
from ..schema.series import Pairs


@dataclass
class MeshPlace:
    """Draft of one mesh: names (of all equal meshes, and its own), gears, and the data of its law.

    ``ahead`` is the angle [rad] from planet 1 to the mesh's own. ``in_plane`` means that the law uses the gears'
    positions, ``backwards`` that the contact moves away from the tip of gear 1, ``switched`` that a level is needed.
    """

    name: str
    label: str
    stage: Planetary | Pair
    mesh: Mesh
    wheels: tuple[Gear, Gear]
    sigma: int
    members: tuple[str, str]
    direction: float
    ahead: float = 0.0
    sense: int = 1
    in_plane: bool = True
    backwards: bool = False
    switched: bool = False

    @property
    def geometry(self) -> tuple[Planetary | Pair, Mesh, Gear, Gear, int]:
        """Return the arguments of the functions of ``mesh_stiffness``."""
        return self.stage, self.mesh, *self.wheels, self.sigma


@dataclass
class Draft:
    """The model during assembly (the only mutable value of the pipeline)."""

    scene: Scene
    rigid: RigidMotion
    statics: dict[str, float]
    bodies: list[Body] = field(default_factory=list)
    instances: list[Instance] = field(default_factory=list)
    levels: list[Level] = field(default_factory=list)
    phases: list[Phase] = field(default_factory=list)
    profiles: list[Profile] = field(default_factory=list)
    parameters: dict[str, Parameter] = field(default_factory=dict)
    frames: dict[str, str | None] = field(default_factory=lambda: {"": None})
    leaders: dict[str, str] = field(default_factory=dict)
    signals: dict[str, Signal] = field(default_factory=dict)
    tables: dict[str, Pairs] = field(default_factory=dict)
    clocks: list[Clock] = field(default_factory=list)

    def number(self, name: str, value: float, unit: str, role: str = PHYSICAL, bounds: str = ANY) -> str:
        """Register a parameter and return its name."""
        self.parameters[name] = Parameter(name, float(value), unit, role, bounds)
        return name

    def stiffness(self, name: str, value: float, unit: str = "N/m") -> str:
        """Register the stiffness of a spring."""
        return self.number(name, value, unit, bounds=NOT_NEGATIVE)

    def hold(self, border: str, unit: str) -> str:
        """Register the parameter that holds the regime on one side of a border."""
        return self.number(HOLD + border, 0.0, unit, REGIME)

    def signal(self, name: str, unit: str, table: str, pairs: Pairs, quantity: str, slope: bool = False) -> str:
        """Register a load signal with its table, and return its name."""
        self.signals[name] = Signal(name, unit, table, slope, quantity)
        self.tables[table] = pairs
        return name

    def turn(self, name: str, ratio: str | None, frame: str | None = None) -> None:
        """Register the initial angle of a continuous rotation, once for all equal rotations."""
        known = {(clock.ratio, clock.frame) for clock in self.clocks if not clock.mesh}
        if ratio != frame and (ratio or "", frame or "") not in known:
            start = self.number(f"{name}.start_angle", 0.0, "rad", GEOMETRY)
            self.clocks.append(Clock(start, "", ratio or "", frame or ""))

    def place(self, name: str, element: ElementKey, bodies: tuple[str, ...], family: str = "", **bind: str) -> None:
        """Register an element instance, with a family if it connects bodies."""
        self.instances.append(Instance(name, element, bodies, bind, family))

    def placed(self) -> tuple[Instance, ...]:
        """Return the element instances, with the live axes of this model's bodies in their keys."""
        sideways = any(body.lateral or body.place for body in self.bodies)
        live = tuple(axis.name for axis in PLANE if axis.rotation or sideways)
        return tuple(
            replace(item, element=replace(item.element, live=(live,) * len(item.bodies))) for item in self.instances
        )

    def series(self, name: str, series: list[float], unit: str, bounds: str = ANY) -> tuple[str, ...]:
        """Register mean and amplitudes of a series; the bounds are those of the mean."""
        names = [f"{name}_{part}_{n}" for n in range(1, len(series) // 2 + 1) for part in ("cos", "sin")]
        mean = self.number(f"{name}_mean", series[0], unit, bounds=bounds)
        return mean, *(self.number(key, value, unit) for key, value in zip(names, series[1:], strict=True))

    @property
    def rayleigh(self) -> Rayleigh | None:
        """Return the two factors of Rayleigh damping where the scene calls for it."""
        return self.scene.rayleigh if self.scene.effects["damping"] == "rayleigh" else None

    def on(self, effect: str) -> bool:
        """Tell whether an on/off effect is on."""
        return self.scene.effects[effect] == "on"
