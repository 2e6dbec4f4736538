"""Axes of motion, translational and rotational; the planar model is one choice of them."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Axis:
    """An axis along which, or about which, a body moves.

    Attributes
    ----------
    name, rate
        Letter of the coordinate and of its rate in the laws of elements.
    rotation
        Whether the motion is a rotation about the axis; else it is a translation along it.
    deviation
        Letter of the integrated coordinate: the deviation of the first from the rigid motion.
    """

    name: str
    rate: str
    rotation: bool
    deviation: str

    @property
    def unit(self) -> str:
        """Return the unit of the coordinate."""
        return "rad" if self.rotation else "m"

    @property
    def rate_unit(self) -> str:
        """Return the unit of the rate."""
        return f"{self.unit}/s"

    @property
    def load_unit(self) -> str:
        """Return the unit of a force along the axis, or of a torque about it."""
        return "N*m" if self.rotation else "N"


X, Y = (Axis(name, f"v{name}", rotation=False, deviation=name) for name in "xy")
THETA = Axis("theta", "omega", rotation=True, deviation="u")
PLANE = (X, Y, THETA)
"""Axes of a body in the plane."""
SIDEWAYS = (X, Y)
DEVIATIONS = {axis.deviation: axis for axis in PLANE}
"""Letter of a degree of freedom -> its axis."""
