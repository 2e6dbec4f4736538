"""Patience: runs that are given up when they take too long, so that one setting cannot hold up all others."""

from dataclasses import dataclass
from time import perf_counter

from ltcgear.generated.errors import SolverError

from ..hard.case import Bench
from ..integration import Trajectory


class OutOfTimeError(SolverError):
    """A run took longer than it may."""


@dataclass(frozen=True)
class Patience:
    """How long one run may take [s]."""

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
        clock = perf_counter()

        def told(time: float) -> None:
            if perf_counter() - clock > self.seconds:
                raise OutOfTimeError(f"more than {self.seconds:g} s for {time:.3g} s of {t_end:.3g} s")

        try:
            return bench.run(method, t_end=t_end, rate=rate, rtol=rtol, told=told)
        except SolverError as error:
            if "interrupted" in str(error):
                raise KeyboardInterrupt from error
            raise
