"""Schema of a scene: strict pydantic models; every quantity is text with a unit."""

from collections.abc import Iterator, Sequence
from difflib import get_close_matches
from typing import Annotated, Literal

from ltcgear.generated.contract import MOST_SAMPLES
from pydantic import BeforeValidator, Field

from .effects import DEFAULTS, EFFECTS, contradictions
from .mesh_schema import Mesh
from .quantities import (
    Acceleration,
    Angle,
    Bore,
    BreakdownTorque,
    Damping,
    DecayRate,
    DecayTime,
    Density,
    Duration,
    Force,
    Inertia,
    Length,
    Line,
    Mass,
    Module,
    Name,
    Rate,
    Ratio,
    SceneTable,
    SmallSpeed,
    Speed,
    SpeedOverTime,
    Stiffness,
    Title,
    Torque,
    TorqueOverTime,
    TorsionalDamping,
    TorsionalStiffness,
)

MOST_PLANETS = 24
MOST_MEMBERS = 300  # planets included
PARTS = {"planetary": ("ring", "sun", "carrier"), "pair": ("input", "output")}


class Disc(SceneTable):
    """Solid or hollow disc from which mass and inertia are computed (default: steel)."""

    outer_diameter: Length
    width: Length
    inner_diameter: Bore = 0.0
    density: Density = 7850.0

    def faults(self) -> Iterator[str]:
        """Check the bore."""
        if not 0 <= self.inner_diameter < self.outer_diameter:
            yield ".inner_diameter: must lie between zero and outer_diameter"


class Bearing(SceneTable):
    """Isotropic radial spring-damper; a damping ratio refers to the member's own mass.

    The radial ``clearance`` acts when ``bearing_clearance`` is on.
    """

    stiffness: Stiffness
    damping: Damping | None = None
    damping_ratio: Ratio | None = None
    clearance: Bore | None = None

    def faults(self) -> Iterator[str]:
        """Check the clearance."""
        yield from super().faults()
        if self.clearance is not None and self.clearance < 0:
            yield ".clearance: must not be negative; a bearing that is preloaded has none"


class PinBearing(Bearing):
    """Planet bearing; the friction keys act when ``bearing_friction`` is on."""

    diameter: Length | None = None
    friction: Annotated[float, Field(ge=0, lt=1)] = 0.0
    friction_damping: TorsionalDamping | None = None
    friction_speed: SmallSpeed = 0.1
    friction_load: Force = 1.0

    def faults(self) -> Iterator[str]:
        """Check that friction has its lever arm."""
        yield from super().faults()
        if self.friction and self.diameter is None:
            yield ".diameter: is missing; the torque of friction acts on it"


class TorsionalSupport(SceneTable):
    """Torsional spring-damper to the housing; a damping ratio refers to the member's own inertia."""

    stiffness: TorsionalStiffness
    damping: TorsionalDamping | None = None
    damping_ratio: Ratio | None = None


class Member(SceneTable):
    """A rotating body; mass and inertia are given, or computed from a disc."""

    support: Literal["fixed", "rigid", "bearing", "floating"] = "floating"
    bearing: Bearing | None = None
    torsional_support: TorsionalSupport | None = None
    drag: TorsionalDamping | None = None
    mass: Mass | None = None
    inertia: Inertia | None = None
    disc: Disc | None = None

    def faults(self) -> Iterator[str]:
        """Check support and inertia."""
        if (self.support == "bearing") != (self.bearing is not None):
            yield 'support = "bearing" and a bearing table belong together'
        if self.support == "fixed" and self.torsional_support is not None:
            yield 'support = "fixed" holds it already; drop torsional_support, or free the member'
        if self.disc is not None and (self.mass is not None or self.inertia is not None):
            yield "give either a disc, or mass and inertia"
        needs: tuple[str, ...] = {"fixed": (), "rigid": ("inertia",)}.get(self.support, ("mass", "inertia"))
        missing = [key for key in needs if getattr(self, key) is None]
        if self.disc is None and missing:
            verb = "is" if len(missing) == 1 else "are"
            yield f'{" and ".join(missing)} {verb} missing for support = "{self.support}"; give it or a disc'


class Eccentricity(SceneTable):
    """Offset of a gear's tooth centre from its axis, and its direction at angle zero; acts with ``eccentricity``."""

    radius: Bore
    angle: Angle = 0.0


class Gear(Member):
    """A gear: teeth (radii then follow from module and angles) or an explicit base radius.

    ``tooth_thinning`` is the tooth thickness allowance in the normal section on the reference circle (DIN 3967); with
    ``contact = "backlash"`` it adds to the gap.
    """

    teeth: Annotated[int, Field(ge=3, le=100000)] | None = None
    profile_shift: Annotated[float, Field(gt=-2, lt=2)] = 0.0
    tooth_thinning: Bore = 0.0
    base_radius: Length | None = None
    eccentricity: Eccentricity | None = None


class Stage(SceneTable):
    """Base of planetary stages and parallel pairs: the tooth system."""

    module: Module | None = None
    pressure_angle: Angle | None = None
    helix_angle: Angle = 0.0
    center_distance: Length | None = None
    line_of_centres: Angle = 0.0


class PositionError(SceneTable):
    """Position error of a planet's pin: outwards, and counter-clockwise along the pin circle.

    It acts when ``planet_position_error`` is on.
    """

    planet: Annotated[int, Field(ge=1)]
    radial: Bore = 0.0
    tangential: Bore = 0.0


class PlanetEccentricity(Eccentricity):
    """The eccentricity of one planet's teeth."""

    planet: Annotated[int, Field(ge=1)]


class Planetary(Stage):
    """A planetary stage: ring, sun, carrier and equal planets."""

    kind: Literal["planetary"]
    planets: Annotated[int, Field(ge=1, le=MOST_PLANETS)]
    planet_angles: Annotated[list[Angle], Field(max_length=MOST_PLANETS)] | None = None
    ring: Gear
    sun: Gear
    planet: Gear
    carrier: Member
    sun_planet: Mesh
    ring_planet: Mesh
    pin: PinBearing
    position_errors: Annotated[list[PositionError], Field(max_length=MOST_PLANETS)] = []
    eccentricities: Annotated[list[PlanetEccentricity], Field(max_length=MOST_PLANETS)] = []

    def faults(self) -> Iterator[str]:
        """Check the planets."""
        for key in ("support", "bearing", "torsional_support", "drag"):
            if key in self.planet.model_fields_set and getattr(self.planet, key) not in (None, "floating"):
                yield f".planet.{key}: a planet is carried by its pin alone; leave {key} out"
        if self.planet.eccentricity is not None:
            yield ".planet.eccentricity: planets differ; give the stage eccentricities = [{ planet = 1, radius = ... }]"
        for key in ("position_errors", "eccentricities"):
            named = [error.planet for error in getattr(self, key)]
            for number in sorted({n for n in named if n > self.planets or named.count(n) > 1}):
                yield f".{key}: planet {number} must be one of 1 to {self.planets}, each once"
        if self.planet_angles is not None and len(self.planet_angles) != self.planets:
            yield f".planet_angles: {len(self.planet_angles)} angles for planets = {self.planets}; give one a planet"


class Pair(Stage):
    """A pair of gears on parallel shafts; a helical pair is modelled in its transverse plane."""

    kind: Literal["pair"]
    input: Gear
    output: Gear
    mesh: Mesh


class Rotor(SceneTable):
    """An inertia that only rotates: motor, shaft, generator."""

    inertia: Inertia | None = None
    disc: Disc | None = None
    drag: TorsionalDamping | None = None
    torsional_support: TorsionalSupport | None = None

    def faults(self) -> Iterator[str]:
        """Check the inertia."""
        if (self.inertia is None) == (self.disc is None):
            yield "give either inertia or a disc"


class Coupling(SceneTable):
    """A torsional spring-damper between two members; a damping ratio refers to their reduced inertia."""

    between: Annotated[list[str], Field(min_length=2, max_length=2)]
    stiffness: TorsionalStiffness
    damping: TorsionalDamping | None = None
    damping_ratio: Ratio | None = None


class Slip(SceneTable):
    """Slip law of an asynchronous machine: above its synchronous speed it brakes, below it drives."""

    synchronous_speed: Speed
    breakdown_torque: BreakdownTorque
    breakdown_slip: Ratio

    def faults(self) -> Iterator[str]:
        """Check that the slip is defined."""
        if self.synchronous_speed == 0:
            yield ".synchronous_speed: must not be zero, slip refers to it"


class Load(SceneTable):
    """Load on a member: a prescribed speed, or a torque (with the speed at the start).

    Over time both are linear between the rows of their table and constant beyond its ends.
    """

    member: str
    speed: Speed | None = None
    speed_over_time: SpeedOverTime | None = None
    torque: Torque | None = None
    torque_over_time: TorqueOverTime | None = None
    slip: Slip | None = None
    initial_speed: Speed | None = None

    @property
    def holds(self) -> bool:
        """Tell whether it prescribes a speed."""
        return self.speed is not None or self.speed_over_time is not None

    def faults(self) -> Iterator[str]:
        """Check that there is exactly one load."""
        kinds = ("speed", "torque", "speed_over_time", "torque_over_time", "slip")
        given = [kind for kind in kinds if getattr(self, kind) is not None]
        if len(given) != 1:
            yield f"give either speed or torque, one of {', '.join(kinds)}" + (
                f", not {' and '.join(given)}" * bool(given)
            )
        if self.holds and self.initial_speed is not None:
            yield ".initial_speed: goes with torque; speed is held from the start"
        if self.speed_over_time is not None and not any(speed for _, speed in self.speed_over_time):
            yield '.speed_over_time: is zero throughout; write speed = "0 rpm"'


class Rayleigh(SceneTable):
    """Factors of Rayleigh damping, C = mass M + stiffness K; acts when ``damping`` is ``rayleigh``."""

    mass: DecayRate = 0.0
    stiffness: DecayTime = 0.0

    def faults(self) -> Iterator[str]:
        """Check that they damp."""
        for key in ("mass", "stiffness"):
            if getattr(self, key) < 0:
                yield f".{key}: must not be negative"
        if self.mass == self.stiffness == 0:
            yield "damps nothing; give mass or stiffness, or both"


class Simulation(SceneTable):
    """Defaults of ``ltcgear simulate`` for this scene."""

    t_end: Duration = 0.5
    rate: Rate | None = None

    def faults(self) -> Iterator[str]:
        """Check that the number of samples is bounded."""
        if self.rate is not None and self.t_end * self.rate > MOST_SAMPLES:
            asked = f"{self.t_end * self.rate:.2g} samples"
            yield f".rate: t_end times rate are {asked}, above {MOST_SAMPLES:.0e}; lower one"


def _effects(chosen: object) -> dict[str, str]:
    """Check the effects against the table and fill in the defaults."""
    if not isinstance(chosen, dict):
        raise ValueError(f"must be a table, not {chosen!r:.60}")
    allowed = {effect.name: effect.values for effect in EFFECTS}
    faults = []
    for key, value in chosen.items():
        if key not in allowed:
            faults.append(f".{key}: unknown effect; {suggest(key, list(allowed), 'effects')}")
        elif value not in allowed[key]:
            faults.append(f".{key}: {value!r:.60} is not a value of it; {suggest(value, allowed[key], 'values')}")
    faults = faults or list(contradictions(DEFAULTS | chosen))
    if faults:
        raise ValueError("\n".join(faults))
    return DEFAULTS | chosen


def suggest(name: object, known: Sequence[str], what: str) -> str:
    """Return the cure for an unknown name: the nearest one, or all names."""
    near = get_close_matches(str(name)[:80], known, 1)
    return f'did you mean "{near[0]}"?' if near else f"{what}: {', '.join(known)}"


class Scene(SceneTable):
    """A gearbox, its loads and the effects it calls for; immutable and in SI units."""

    title: Title
    name: Line = "scene"
    stages: dict[Name, Annotated[Planetary | Pair, Field(discriminator="kind")]] = {}
    rotors: dict[Name, Rotor] = {}
    couplings: dict[Name, Coupling] = {}
    loads: dict[Name, Load] = {}
    gravity: Annotated[list[Acceleration], Field(min_length=2, max_length=2)] = [0.0, -9.80665]
    effects: Annotated[dict[str, str], BeforeValidator(_effects)] = DEFAULTS
    simulation: Simulation = Simulation()
    rayleigh: Rayleigh | None = None
    sources: dict[str, Line] = {}
