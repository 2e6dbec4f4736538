"""The gear pair with a dead band, written by hand without dimensions and integrated by SciPy with located events.

Kahraman and Singh 1990, J. Sound Vib. 142:49. Lengths over half the gap, times by the natural frequency, y what the
mesh is deflected by less the transmission error e:

    y'' + 2 zeta (y' + own e') + f(y) = F - e'',    f(y) = y - 1 above 1, 0 in the dead band, y + 1 below -1.

Theirs has ``own`` = 0: a damper that sees the mesh alone. With 1 it sees the gear's whole vibration y + e.
"""

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

LONGEST = 0.5
"""Longest step; a twelfth of a natural period, so that no touch is stepped over."""


@dataclass(frozen=True)
class Sweep:
    """Frequencies Omega of the excitation over the time tau, linear between knots and constant beyond them."""

    times: tuple[float, ...]
    frequencies: tuple[float, ...]

    def frequency(self, tau):
        return np.interp(tau, self.times, self.frequencies)

    def angle(self, tau):
        """The integral of Omega from 0."""
        t = np.unique([0.0, tau, *(knot for knot in self.times if 0 < knot < tau)])
        return float(np.trapezoid(self.frequency(t), t))


@dataclass(frozen=True)
class DeadBand:
    zeta: float = 0.05
    force: float = 0.1
    error: float = 0.05
    own: float = 1.0

    def run(self, sweep, end, step, start, rtol=1e-8):
        """y at uniform times below ``end``, from a state (y, y') on."""
        state, now = np.array(start, dtype=float), 0.0
        times, found = np.arange(0.0, end, step), []
        while now < end:
            stop = min([t for t in sweep.times if t > now] + [end])
            done = self._piece(sweep, now, stop, state, rtol)
            inside = times[(times >= now) & (times < done.t[-1])]
            found.append(done.sol(inside)[0] if len(inside) else inside)
            now, state = done.t[-1], done.y[:, -1]
            if done.status == 1:
                state[0] = np.sign(state[0])  # an event lies at a border of the dead band
        return times, np.concatenate(found)

    def _piece(self, sweep, start, stop, state, rtol):
        """Integrate until the teeth part or touch, or to ``stop``."""
        side = np.sign(state[0]) if abs(state[0]) > 1 or (state[0] * state[1] > 0 and abs(state[0]) == 1) else 0.0
        phase, omega = sweep.angle(start), float(sweep.frequency(start))
        slope = (float(sweep.frequency(stop)) - omega) / (stop - start)

        def right(tau, z):
            t = tau - start
            w, turned = omega + slope * t, phase + omega * t + slope * t * t / 2
            speed = -self.error * w * np.sin(turned)
            acceleration = -self.error * (w * w * np.cos(turned) + slope * np.sin(turned))
            pressed = z[0] - side if side else 0.0
            return [z[1], self.force - acceleration - 2 * self.zeta * (z[1] + self.own * speed) - pressed]

        def border(place, direction):
            def event(tau, z):
                return z[0] - place

            event.terminal, event.direction = True, direction
            return event

        events = [border(side, -side)] if side else [border(1.0, 1.0), border(-1.0, -1.0)]
        return solve_ivp(
            right, (start, stop), state, "DOP853", events=events, dense_output=True, max_step=LONGEST,
            rtol=rtol, atol=rtol / 100,
        )  # fmt: skip


def amplitudes(tau, y, sweep):
    """Frequency at the middle of each whole cycle of the excitation, and half of what y moves through within it."""
    angle = np.concatenate(
        [[0.0], np.cumsum(np.diff(tau) * (sweep.frequency(tau)[1:] + sweep.frequency(tau)[:-1]) / 2)]
    )
    first = np.searchsorted(angle, 2 * np.pi * np.arange(int(angle[-1] / (2 * np.pi)) + 1))
    most, least = np.maximum.reduceat(y, first), np.minimum.reduceat(y, first)
    middle = tau[(first[:-1] + first[1:]) // 2]
    return middle, sweep.frequency(middle), ((most - least) / 2)[:-1]
