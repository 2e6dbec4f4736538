"""The scene's schema: strict pydantic models; every quantity is text with a unit."""

from dataclasses import dataclass
from typing import Annotated, Literal

from pydantic import BaseModel, BeforeValidator, ConfigDict, Field, GetCoreSchemaHandler, model_validator
from pydantic_core import core_schema

from . import units
from .effects import DEFAULTS, EFFECTS


@dataclass(frozen=True)
class Quantity:
    """Marks a float field that is written as text with a unit and kept in SI."""

    unit: str
    positive: bool = False

    def read(self, value: object) -> float:
        """Convert the text of a scene."""
        number = units.parse(value, self.unit)
        if self.positive and number <= 0:
            raise ValueError(f"{value!r} must be greater than zero")
        return number

    def __get_pydantic_core_schema__(self, source: object, handler: GetCoreSchemaHandler) -> core_schema.CoreSchema:
        """Tell pydantic how to read and write the field."""
        write = core_schema.plain_serializer_function_ser_schema(lambda value: f"{value!r} {self.unit}".strip())
        return core_schema.no_info_before_validator_function(self.read, core_schema.float_schema(), serialization=write)


Length = Annotated[float, Quantity("m", positive=True)]
Bore = Annotated[float, Quantity("m")]
Angle = Annotated[float, Quantity("rad")]
Mass = Annotated[float, Quantity("kg", positive=True)]
Inertia = Annotated[float, Quantity("kg*m^2", positive=True)]
Stiffness = Annotated[float, Quantity("N/m", positive=True)]
TorsionalStiffness = Annotated[float, Quantity("N*m/rad", positive=True)]
Damping = Annotated[float, Quantity("N*s/m", positive=True)]
TorsionalDamping = Annotated[float, Quantity("N*m*s/rad", positive=True)]
Density = Annotated[float, Quantity("kg/m^3", positive=True)]
Duration = Annotated[float, Quantity("s", positive=True)]
Rate = Annotated[float, Quantity("1/s", positive=True)]
Speed = Annotated[float, Quantity("rad/s")]
SmallSpeed = Annotated[float, Quantity("rad/s", positive=True)]
Torque = Annotated[float, Quantity("N*m")]
Force = Annotated[float, Quantity("N", positive=True)]
Acceleration = Annotated[float, Quantity("m/s^2")]
Velocity = Annotated[float, Quantity("m/s", positive=True)]
Ratio = Annotated[float, Field(gt=0, lt=1)]
Name = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]*$", max_length=40)]


class Table(BaseModel):
    """A table of the scene file; unknown keys are refused, values do not change."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)


class Disc(Table):
    """Solid or hollow disc from which mass and inertia are computed (default: steel)."""

    outer_diameter: Length
    width: Length
    inner_diameter: Bore = 0.0
    density: Density = 7850.0

    @model_validator(mode="after")
    def _hollow(self) -> "Disc":
        if not 0 <= self.inner_diameter < self.outer_diameter:
            raise ValueError("inner_diameter must lie between zero and outer_diameter")
        return self


class Bearing(Table):
    """Isotropic radial spring-damper; a damping ratio refers to the member's own mass."""

    stiffness: Stiffness
    damping: Damping | None = None
    damping_ratio: Ratio | None = None


class PinBearing(Bearing):
    """Planet bearing; the friction keys act when ``bearing_friction`` is on."""

    diameter: Length | None = None
    friction: Annotated[float, Field(ge=0, lt=1)] = 0.0
    friction_damping: TorsionalDamping | None = None
    friction_speed: SmallSpeed = 0.1
    friction_load: Force = 1.0


class TorsionalSupport(Table):
    """Torsional spring-damper to the housing; a damping ratio refers to the member's own inertia."""

    stiffness: TorsionalStiffness
    damping: TorsionalDamping | None = None
    damping_ratio: Ratio | None = None


class Member(Table):
    """A body that turns; mass and inertia are given, or computed from a disc."""

    support: Literal["fixed", "rigid", "bearing", "floating"] = "floating"
    bearing: Bearing | None = None
    torsional_support: TorsionalSupport | None = None
    drag: TorsionalDamping | None = None
    mass: Mass | None = None
    inertia: Inertia | None = None
    disc: Disc | None = None

    @model_validator(mode="after")
    def _complete(self) -> "Member":
        if (self.support == "bearing") != (self.bearing is not None):
            raise ValueError('support = "bearing" and a bearing table belong together')
        if self.disc is not None and (self.mass is not None or self.inertia is not None):
            raise ValueError("give either a disc, or mass and inertia")
        needs = {"fixed": (), "rigid": ("inertia",)}.get(self.support, ("mass", "inertia"))
        if self.disc is None and any(getattr(self, key) is None for key in needs):
            raise ValueError(f"{' and '.join(needs)} (or a disc) are missing for support = {self.support!r}")
        return self


class Gear(Member):
    """A gear: teeth (radii then follow from module and angles) or an explicit base radius."""

    teeth: Annotated[int, Field(ge=3, le=100000)] | None = None
    profile_shift: Annotated[float, Field(gt=-2, lt=2)] = 0.0
    base_radius: Length | None = None


class Friction(Table):
    """Pitch-point friction of a mesh; acts when ``mesh_friction`` is on."""

    coefficient: Annotated[float, Field(ge=0, lt=1)]
    speed: Velocity = 0.01
    damping: Damping | None = None


class Mesh(Table):
    """A gear mesh.

    ``stiffness`` is that of single contact (or the constant one); alternatively
    ``torsional_stiffness`` with its ``reference`` gear, k = K / r_b^2. ``double_factor`` is the
    paper's xi: double contact is that much stiffer. Without it the stiffness is constant.
    """

    stiffness: Stiffness | None = None
    torsional_stiffness: TorsionalStiffness | None = None
    reference: Literal["sun", "ring", "planet", "input", "output"] | None = None
    double_factor: Annotated[float, Field(ge=1, le=3)] | None = None
    contact_ratio: Annotated[float, Field(gt=1, lt=2)] | None = None
    phase: Annotated[float, Field(ge=-1, le=1)] = 0.0
    damping: Damping | None = None
    damping_ratio: Ratio | None = None
    flank: Literal["auto", "printed", "opposite"] = "auto"
    friction: Friction | None = None

    @model_validator(mode="after")
    def _stiffness(self) -> "Mesh":
        if (self.stiffness is None) == (self.torsional_stiffness is None):
            raise ValueError("give either stiffness, or torsional_stiffness with its reference gear")
        if (self.torsional_stiffness is None) != (self.reference is None):
            raise ValueError("torsional_stiffness and reference belong together")
        return self


class Stage(Table):
    """What planetary stages and parallel pairs share: the tooth system."""

    module: Length | None = None
    pressure_angle: Angle | None = None
    helix_angle: Angle = 0.0
    center_distance: Length | None = None
    line_of_centres: Angle = 0.0


class Planetary(Stage):
    """A planetary stage: ring, sun, carrier and equal planets."""

    kind: Literal["planetary"]
    planets: Annotated[int, Field(ge=1, le=24)]
    planet_angles: list[Angle] | None = None
    ring: Gear
    sun: Gear
    planet: Gear
    carrier: Member
    sun_planet: Mesh
    ring_planet: Mesh
    pin: PinBearing

    @model_validator(mode="after")
    def _planets(self) -> "Planetary":
        if self.planet.support != "floating" or self.planet.bearing:
            raise ValueError("a planet is carried by its pin; leave its support out")
        if self.planet_angles is not None and len(self.planet_angles) != self.planets:
            raise ValueError(f"planet_angles needs {self.planets} angles")
        return self


class Pair(Stage):
    """A pair of gears on parallel shafts; a helical pair is modelled in its transverse plane."""

    kind: Literal["pair"]
    input: Gear
    output: Gear
    mesh: Mesh


class Rotor(Table):
    """An inertia that only turns: motor, shaft, generator."""

    inertia: Inertia | None = None
    disc: Disc | None = None
    drag: TorsionalDamping | None = None
    torsional_support: TorsionalSupport | None = None

    @model_validator(mode="after")
    def _complete(self) -> "Rotor":
        if (self.inertia is None) == (self.disc is None):
            raise ValueError("give either inertia or a disc")
        return self


class Coupling(Table):
    """A torsional spring-damper between two members; a damping ratio refers to their reduced inertia."""

    between: Annotated[list[str], Field(min_length=2, max_length=2)]
    stiffness: TorsionalStiffness
    damping: TorsionalDamping | None = None
    damping_ratio: Ratio | None = None


class Load(Table):
    """What acts on a member: a speed that is held, or a torque (with the speed at the start)."""

    member: str
    speed: Speed | None = None
    torque: Torque | None = None
    initial_speed: Speed | None = None

    @model_validator(mode="after")
    def _one(self) -> "Load":
        if (self.speed is None) == (self.torque is None):
            raise ValueError("give either speed or torque")
        if self.speed is not None and self.initial_speed is not None:
            raise ValueError("initial_speed goes with torque, speed is held from the start")
        return self


class Simulation(Table):
    """Defaults of ``ltcgear simulate`` for this scene."""

    t_end: Duration = 0.5
    rate: Rate = 8192.0


def _effects(chosen: object) -> dict[str, str]:
    """Check the effects against the table and fill in the defaults."""
    if not isinstance(chosen, dict):
        raise ValueError("a table is due here")
    allowed = {effect.name: effect.values for effect in EFFECTS}
    faults = [f"{key!r} is not an effect; there are {', '.join(allowed)}" for key in chosen if key not in allowed]
    for key, values in allowed.items():
        if key in chosen and chosen[key] not in values:
            faults.append(f"{key} = {chosen[key]!r}, allowed are {', '.join(values)}")
    if faults:
        raise ValueError("; ".join(faults))
    return DEFAULTS | chosen


class Scene(Table):
    """A gearbox, its loads and the effects it calls for; immutable and in SI units."""

    title: str
    name: str = "scene"
    stages: dict[Name, Annotated[Planetary | Pair, Field(discriminator="kind")]] = {}
    rotors: dict[Name, Rotor] = {}
    couplings: dict[Name, Coupling] = {}
    loads: dict[Name, Load] = {}
    gravity: Annotated[list[Acceleration], Field(min_length=2, max_length=2)] = [0.0, -9.80665]
    effects: Annotated[dict[str, str], BeforeValidator(_effects)] = DEFAULTS
    simulation: Simulation = Simulation()
    sources: dict[str, str] = {}
