"""Time limits of measured runs."""

from dataclasses import dataclass
from time import perf_counter

from ltcgear.generated.errors import LtcgearError, MachineError, SolverError

from ...simulation.trajectory import Trajectory
from ..selftest.case import Bench

FEWEST = 64
"""Samples below which a time is too short to be judged."""


class OutOfTimeError(SolverError):
    """A run took longer than it may.

    Attributes
    ----------
    reached
        The time simulated until then [s].
    """

    def __init__(self, message: str, reached: float) -> None:
        super().__init__(message)
        self.reached = reached


@dataclass(frozen=True)
class Patience:
    """How long one run may take [s], not counting what is compiled for it."""

    seconds: float

    def run(self, bench: Bench, method: str, rtol: float, *, t_end: float, rate: float) -> Trajectory:
        """Run from the equilibrium.

        Raises
        ------
        OutOfTimeError
            If it takes too long.
        SolverError
            If it does not reach its end.
        LtcgearError
            If the method refuses the model.
        KeyboardInterrupt
            If Ctrl-C stopped it.
        """
        started: list[float] = []

        def told(time: float) -> None:
            started.append(perf_counter())
            if started[-1] - started[0] > self.seconds:
                raise OutOfTimeError(f"more than {self.seconds:g} s for {time:.3g} s of {t_end:.3g} s", time)

        try:
            return bench.run(method, t_end=t_end, rate=rate, rtol=rtol, told=told)
        except SolverError as error:
            if str(error).startswith("interrupted"):
                raise KeyboardInterrupt from error
            raise

    def reach(self, bench: Bench, method: str, rtol: float, *, t_end: float, rate: float) -> float:
        """Return the time [s] that a run reaches with this patience, ``t_end`` at most, to two digits.

        A run that fails for another reason, or is slow at its very start, does not shorten the time.
        """
        try:
            self.run(bench, method, rtol, t_end=t_end, rate=rate)
        except OutOfTimeError as error:
            samples = round(float(f"{error.reached:.2g}") * rate)
            return samples / rate if samples >= FEWEST else t_end
        except MachineError:
            raise
        except LtcgearError:
            pass
        return t_end
