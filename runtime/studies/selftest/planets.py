"""A planetary stage with a standing carrier and rubbing planet bearings, as one rigid train in closed form."""

from collections.abc import Mapping
from dataclasses import dataclass
from math import cos, pi, sin

import numpy as np
from scipy.integrate import quad
from scipy.optimize import brentq

ALPHA = 20 * pi / 180
"""Pressure angle of the shipped scene, whose gears are at their nominal centre distance."""


@dataclass(frozen=True)
class RubbingPlanets:
    """Sun, ring and n planets that turn together; positive is how the sun's torque turns a planet.

    Inertias [kg m^2], base radii [m], torques on sun and ring [N m], the bearing's mu d / 2 [m] and the speed
    [rad/s] and force [N] that regularise its friction.
    """

    inertia: tuple[float, float, float]
    radius: tuple[float, float, float]
    torque: tuple[float, float]
    arm: float
    slow: float
    light: float
    n: int = 3

    @classmethod
    def of(cls, values: Mapping[str, float], **changes: float) -> "RubbingPlanets":
        """Read the scene ``hard-friction``."""
        v = {**values, **changes}
        radius = tuple(
            v[f"gear.{key}"]
            for key in ("sun_planet.base_radius_1", "ring_planet.base_radius_1", "sun_planet.base_radius_2")
        )
        inertia = tuple(v[f"gear.{key}.inertia"] for key in ("sun", "ring", "planet"))
        return cls(
            (inertia[0], inertia[1], inertia[2]), (radius[0], radius[1], radius[2]),
            (v["loads.sun.torque"], v["loads.ring.torque"]), v["gear.pin.friction"] * v["gear.pin.diameter"] / 2,
            v["gear.pin.friction_speed"], v["gear.pin.friction_load"],
        )  # fmt: skip

    def friction(self, gain: float) -> tuple[float, float]:
        """Return the torque that drives one planet, and the most its bearing rubs [N m], at an acceleration [rad/s^2].

        Sun and ring press on the planet with what their inertia leaves of their torque, from both sides and both
        forwards, so that the bearing carries 2 N cos alpha, and the difference N sin alpha across.
        """
        (i_s, i_r, i_p), (r_s, r_r, r_p) = self.inertia, self.radius
        sun = (self.torque[0] - i_s * gain * r_p / r_s) / (self.n * r_s)
        ring = (self.torque[1] + i_r * gain * r_p / r_r) / (self.n * r_r)
        load = np.hypot((sun + ring) * cos(ALPHA), (sun - ring) * sin(ALPHA))
        return (sun - ring) * r_p - i_p * gain, self.arm * float(np.hypot(load, self.light))

    def gain(self, share: float) -> float:
        """Return the acceleration [rad/s^2] where the bearing rubs with a share of the most, negative if backwards."""

        def missing(gain: float) -> float:
            driven, most = self.friction(gain)
            return driven - share * most

        return float(brentq(missing, -1e6, 1e6, xtol=1e-12, rtol=1e-14))

    @property
    def creep(self) -> float:
        """Return the speed [rad/s] at which the regularised bearing holds a torque below its limit."""
        driven, most = self.friction(0.0)
        return self.slow * float(np.arctanh(driven / most))

    def stopping_angle(self, speed: float) -> float:
        """Return the angle [rad] that a planet turns from a speed [rad/s] to rest: the integral of w dw / w'."""
        return float(quad(lambda w: -w / self.gain(np.tanh(w / self.slow)), 0.0, speed, points=[5 * self.slow])[0])

    def limit(self) -> float:
        """Return the torque on the sun [N m] at which the bearings begin to slip under Coulomb's law."""

        def over(torque: float) -> float:
            driven, most = RubbingPlanets(
                self.inertia, self.radius, (torque, self.torque[1]), self.arm, self.slow, self.light, self.n
            ).friction(0.0)
            return driven - most

        return float(brentq(over, self.torque[0], 2 * self.torque[0], xtol=1e-12))
