"""Quantities of a scene's tables: strict keys, and numbers as text with a unit."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Annotated, Self

from pydantic import AfterValidator, BaseModel, ConfigDict, Field, GetCoreSchemaHandler, model_validator
from pydantic_core import core_schema

from . import units
from .ranges import MODULE, RANGES, check_range
from .series import Pairs, Series

JOINERS = "\u200c\u200d"
"""Joining characters that some scripts need between letters."""


@dataclass(frozen=True)
class Quantity:
    """Marker of a float field that is written as text with a unit and kept in SI.

    ``bounds`` default to those of its unit.
    """

    unit: str
    positive: bool = False
    bounds: tuple[float, float] | None = None

    def read(self, value: object) -> float:
        """Convert the text of a scene."""
        number = units.parse(value, self.unit)
        check_range(number, self.unit, f"{value!r:.60}", self.bounds or RANGES[self.unit], self.positive)
        return number

    def __get_pydantic_core_schema__(self, source: object, handler: GetCoreSchemaHandler) -> core_schema.CoreSchema:
        """Tell pydantic how to read and write the field."""
        write = core_schema.plain_serializer_function_ser_schema(lambda value: f"{value!r} {self.unit}".strip())
        return core_schema.no_info_before_validator_function(self.read, core_schema.float_schema(), serialization=write)


def check_line(text: str) -> str:
    """Return a text if it is a single line of printable characters.

    Raises
    ------
    ValueError
        If it holds a line break, a tab, an escape, a mark that turns the direction of writing or the like.
    """
    bad = next((c for c in text if not c.isprintable() and c not in JOINERS), None)
    if bad is not None:
        raise ValueError(f"holds {bad!r}, which is no character of a line of text; leave it out")
    return text


Length = Annotated[float, Quantity("m", positive=True)]
Module = Annotated[float, Quantity("m", positive=True, bounds=MODULE)]
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
DecayRate = Annotated[float, Quantity("1/s")]
DecayTime = Annotated[float, Quantity("s")]
Speed = Annotated[float, Quantity("rad/s")]
SmallSpeed = Annotated[float, Quantity("rad/s", positive=True)]
Torque = Annotated[float, Quantity("N*m")]
BreakdownTorque = Annotated[float, Quantity("N*m", positive=True)]
SpeedOverTime = Annotated[Pairs, Series("s", "rad/s")]
TorqueOverTime = Annotated[Pairs, Series("s", "N*m")]
Force = Annotated[float, Quantity("N", positive=True)]
Acceleration = Annotated[float, Quantity("m/s^2")]
Velocity = Annotated[float, Quantity("m/s", positive=True)]
Ratio = Annotated[float, Field(gt=0, lt=1)]
Line = Annotated[str, AfterValidator(check_line)]
Title = Annotated[str, Field(min_length=1, max_length=200), AfterValidator(check_line)]
Name = Annotated[str, Field(pattern=r"^[a-z][a-z0-9_]*$", max_length=40)]


class SceneTable(BaseModel):
    """A table of the scene file; unknown keys are refused, values do not change."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True, allow_inf_nan=False)

    @model_validator(mode="after")
    def _consistent(self) -> Self:
        """Refuse inconsistent keys; one line per defect."""
        found = list(self.faults())
        if found:
            raise ValueError("\n".join(found))
        return self

    def faults(self) -> Iterator[str]:
        """List inconsistencies of this table; a fault of one key begins with ``.key: ``."""
        if getattr(self, "damping", None) is not None and getattr(self, "damping_ratio", None) is not None:
            yield "give either damping or damping_ratio, not both"
