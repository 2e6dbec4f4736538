"""Valid ranges of quantities of a gearbox, from micrometres to the largest machines.

Assumed, with some orders of magnitude of margin on both sides: they catch mistakes in units and exponents.
"""

RANGES = {
    "m": (1e-6, 100.0),
    "rad": (1e-9, 1000.0),
    "kg": (1e-12, 1e7),
    "kg*m^2": (1e-21, 1e10),
    "kg/m^3": (1.0, 1e5),
    "N/m": (1e-6, 1e16),
    "N*m/rad": (1e-12, 1e16),
    "N*s/m": (1e-30, 1e12),
    "N*m*s/rad": (1e-30, 1e12),
    "s": (1e-9, 1e9),
    "1/s": (1e-6, 1e12),
    "rad/s": (1e-9, 1e6),
    "N*m": (1e-12, 1e10),
    "N": (1e-9, 1e10),
    "m/s": (1e-12, 1e4),
    "m/s^2": (1e-9, 1e4),
}
"""SI unit -> lower limit of quantities that must be positive, and upper limit of all magnitudes."""
MODULE = (1e-6, 0.5)
"""Range of a module [m]."""


def check_range(number: float, unit: str, shown: str, bounds: tuple[float, float], positive: bool) -> None:
    """Check that a number in SI lies in a range; ``shown`` is how the scene writes it.

    Raises
    ------
    ValueError
        If it does not.
    """
    least, most = bounds
    if positive and number <= 0:
        raise ValueError(f"{shown} must be greater than zero")
    if abs(number) > most or (positive and number < least):
        span = f"{least:g} to {most:g} {unit}" if positive else f"{most:g} {unit} at most"
        raise ValueError(f"{shown} is no size of a gearbox ({span}); check number and unit")
