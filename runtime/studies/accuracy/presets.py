"""Presets of a measurement: how much is measured, over how long a motion."""

from dataclasses import dataclass

from ltcgear.generated.errors import LtcgearError

from ...model.function import Kernel
from ...model.phase_wrapping import TURN, Clocks
from ...simulation.methods.registry import METHODS
from ..selftest.case import Bench


@dataclass(frozen=True)
class Preset:
    """A preset.

    Attributes
    ----------
    rtols
        Relative tolerances.
    periods, samples
        Pitches of the slowest mesh, and samples, that are simulated at least.
    patience
        The longest that one run may take [s].
    budget
        Time for repeated runs [s].
    """

    rtols: tuple[float, ...]
    periods: float
    samples: int
    patience: float
    budget: float


PRESETS = {
    "quick": Preset((1e-3, 1e-4, 1e-5, 1e-6, 1e-8), 1.1, 256, 3.0, 15.0),
    "full": Preset(tuple(10 ** (-k / 2) for k in range(6, 23)), 2.2, 512, 5.0, 45.0),
}


def check_preset(name: str) -> Preset:
    """Return a preset by its name; LtcgearError for one that there is not."""
    if name not in PRESETS:
        raise LtcgearError(f"--preset {name!r:.60}: unknown; there are {', '.join(PRESETS)}")
    return PRESETS[name]


def installed_methods() -> list[str]:
    """Return the methods whose packages are there."""
    return [name for name, method in METHODS.items() if method.installed]


def choose_time(bench: Bench, preset: Preset, rate: float, longest: float) -> float:
    """Return the time to simulate [s], of samples and of pitches of the slowest mesh that turns, ``longest`` at most.

    Where no mesh turns at the start, it is ``longest``. ``rate`` are samples a second [Hz].
    """
    turning = [each for each in mesh_rates(bench) if each > 0]
    if not turning:
        return longest
    return min(longest, float(f"{max(preset.periods / min(turning), preset.samples / rate):.3g}"))


def mesh_rates(bench: Bench) -> list[float]:
    """Return the mesh frequencies at the start [Hz]."""
    clocks = Clocks(bench.library.manifest, bench.p)
    if clocks.angle is None:
        return []
    rhs = Kernel(bench.library.functions["rhs"])
    speed = abs(float(rhs(bench.at.x, bench.at.s, bench.p)[0][clocks.angle]))
    return [float(abs(course.advance)) * speed / TURN for course in clocks.by_mesh.values()]
