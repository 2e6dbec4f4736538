"""A mass that falls on a spring with a damper that never pulls, in closed form."""

from cmath import phase
from dataclasses import dataclass
from math import pi, sqrt

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from .pair import TorsionalPair

Vector = NDArray[np.float64]


@dataclass(frozen=True)
class Impact:
    """One impact at time 0 with the speed ``v`` [m/s], under a constant force.

    While the teeth touch, the deflection is d + Re C exp(lambda t), with the static one d and C - d and v to begin
    with. They let go where the force k x + c x' falls to zero, x itself being above zero still.
    """

    pair: TorsionalPair
    v: float

    @property
    def fall(self) -> float:
        """Return the acceleration in flight [m/s^2]."""
        return self.pair.static * self.pair.omega**2

    @property
    def root(self) -> complex:
        """Return lambda [1/s]."""
        b = self.pair.c / (2 * self.pair.m)
        return complex(-b, sqrt(self.pair.omega**2 - b**2))

    @property
    def factor(self) -> complex:
        """Return C [m]."""
        d = self.pair.static
        return complex(-d, -(self.v + self.root.real * d) / self.root.imag)

    def touching(self, time: Vector | float) -> tuple[Vector, Vector, Vector]:
        """Return deflection [m], its rate [m/s] and the force [N] while the teeth touch."""
        swing = self.factor * np.exp(self.root * np.asarray(time))
        x, rate = self.pair.static + swing.real, (self.root * swing).real
        return x, rate, self.pair.k * x + self.pair.c * rate

    @property
    def end(self) -> float:
        """Return when the force is zero [s], between the largest deflection and half a swing later."""
        top = (pi / 2 - phase(self.factor * self.root)) / self.root.imag
        return float(brentq(lambda t: float(self.touching(t)[2]), top, top + pi / self.root.imag, xtol=1e-15))

    def motion(self, time: Vector) -> tuple[Vector, Vector, Vector]:
        """Return deflection, its rate and the force before, during and after the impact."""
        x, rate, force = self.touching(time)
        start, speed, _ = self.touching(self.end)
        for free, x_0, v_0, since in ((time < 0, 0.0, self.v, time), (time > self.end, start, speed, time - self.end)):
            x = np.where(free, x_0 + v_0 * since + self.fall * since**2 / 2, x)
            rate = np.where(free, v_0 + self.fall * since, rate)
            force = np.where(free, 0.0, force)
        return x, rate, force
