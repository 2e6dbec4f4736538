"""March: an integration under way, segment by segment of smooth motion between switching instants."""

from dataclasses import asdict, replace
from math import ceil
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .arcs import Arc, Frame
from .clocks import TURN, Clocks
from .equilibrium import Equilibrium
from .extremes import MeshExtremes
from .kernel import Kernel
from .library import Library
from .nodes import Chebyshev, Nodes, Uniform
from .regimes import Regimes, Sides
from .scaling import fastest, vibration_scale
from .signals import Signals
from .stepper import EXPLICIT, MULTISTEP, make_stepper
from .switching import Cells, Phases, at_border, cells_of, crossed, levels_of, lower, time_to_border, upper
from .watch import Watch

Vector = NDArray[np.float64]
MOST_TURNS = 16
"""Turns of the reference in a block of samples, at whose end whole turns are taken off its angle."""
Snapshot = dict[str, NDArray[np.generic]]
KEPT = (
    "z", "time", "unpassed", "turns", "work", "jump_energy", "first_energy", "longest", "first", "fresh", "cells",
    "last_turn", "expected", "heading",
)  # fmt: skip
"""All that a march remembers from segment to segment, besides parameters, sides, counts, extremes and the last step."""
WIDEST = 1000.0
"""Angle [rad] by which the fastest mode turns between two nodes (explicit methods) at most where nothing switches."""
TRIALS = 30
"""How often a segment may be cut before it ends on a border."""
STANDING = 1e-6
"""Speed over the largest of an arc below which a free train stands still."""
LONGEST = 4096
"""By how much a segment may outgrow the one that resolves the fastest mode: found again in 12 halvings."""
UNRESOLVED = (1.0, 10.0)
"""What a segment's nodes may miss, over rtol: one-step methods, multistep methods, whose own errors are larger."""


class March:
    """An integration under way."""

    def __init__(
        self, library: Library, p: Vector, at: Equilibrium, method: str, rtol: float, samples: int, rate: float,
        signals: Signals,
    ) -> None:  # fmt: skip
        self.library, self.signals, self.rtol = library, signals, rtol
        names, kinds = [state.name for state in library.manifest.states], library.manifest.signals
        self.speed = next((i for i, signal in enumerate(kinds) if signal.name == "reference.speed"), None)
        self.angle = names.index("reference.angle") if "reference.angle" in names else -1
        self.held, self.clocks = held_speed(library, p), Clocks(library.manifest, p)
        self.turns = 0 if self.angle < 0 else self.clocks.turns_in(float(at.x[self.angle]))
        self.at = at = replace(at, x=at.x.copy())
        at.x[self.angle] -= TURN * self.turns
        self.p = p = self.clocks.parameters(self.turns)
        self.frame = Frame(at.x, vibration_scale(library, at, p))
        self.nodes, self.longest = self._layout(method, samples, rate)
        self.shortest = self.first = self.longest
        self.unresolved, self.fresh = UNRESOLVED[method in MULTISTEP] * rtol, True
        self.phase_kernel, self.energy_kernel = (
            Kernel(library.functions["phases"]),
            Kernel(library.functions["energy"]),
        )
        self.z = np.zeros(len(at.x))
        self.work = self.jump_energy = self.time = self.unpassed = 0.0
        start = signals.at(0.0)
        self.cells: Cells = cells_of(self.phases(self.z, start))
        self.last_turn, self.expected, self.heading = self.cells, 0, np.zeros(len(self.cells))
        self.free = names.index("reference.speed") if "reference.speed" in names else None
        s = np.concatenate([levels_of(self.cells), start])
        known = self.angle if self.angle >= 0 and self.free is None else None
        self.regimes = Regimes(library, self.p, self.frame, self.nodes, rtol, s, known)
        self.watch = Watch(self.regimes, self.phase_kernel, self.p, self.cells)
        self.stepper = make_stepper(library, method, rtol, self.frame, p, self.nodes.points[1:], self.watch)
        self.first_energy = self.energy(self.z, self.cells, start)
        self.extremes = MeshExtremes(library, p, len(self.nodes.points), samples / rate)

    def _layout(self, method: str, samples: int, rate: float) -> tuple[Nodes, float]:
        """Choose nodes and longest segment [s]: blocks of samples where nothing switches or bends, else Chebyshev.

        A segment in which the fastest mode turns by 8 rad between 17 nodes, or 16 rad between 25, is resolved to
        1e-9 whatever moves. Segments begin with that length, and grow where the fastest modes are at rest. Blocks are
        equally long; explicit methods get nodes between samples that lie far apart, lest they run out of steps.
        """
        quickest, manifest = fastest(self.library, self.at, self.p), self.library.manifest
        if not (manifest.levels or manifest.signals or manifest.holds):
            finer = max(ceil(quickest / rate / WIDEST), 1) if method in EXPLICIT else 1
            turning = self._reference_speed() / (MOST_TURNS * TURN)
            most = max(1, min(256, int(rate / turning) * finer if turning else 256))
            blocks = ceil(samples * finer / most)
            block = ceil(samples * finer / blocks)
            return Uniform(block), block / finer / rate
        count, turn = (24, 16.0) if method in MULTISTEP else (16, 8.0)
        return Chebyshev(count), turn / quickest

    def snapshot(self) -> Snapshot:
        """Return all that the march needs to go on as if it had not stopped."""
        kept = {name: np.array(getattr(self, name)) for name in KEPT}
        kept |= {f"counts.{name}": np.array(value) for name, value in asdict(self.stepper.counts).items()}
        kept |= {f"extremes.{name}": getattr(self.extremes, name).copy() for name in ("lowest", "steady")}
        return kept | {"p": self.p.copy(), "sides": self.regimes.sides, "stepper.last": np.array(self.stepper.last)}

    def restore(self, kept: Snapshot) -> None:
        """Go on from a snapshot."""
        for name in KEPT:
            setattr(self, name, _plain(kept[name]))
        for name in asdict(self.stepper.counts):
            setattr(self.stepper.counts, name, int(kept[f"counts.{name}"]))
        for name in ("lowest", "steady"):
            setattr(self.extremes, name, _plain(kept[f"extremes.{name}"]))
        self.stepper.last = float(kept["stepper.last"])
        self.p[:], self.regimes.sides = kept["p"], _plain(kept["sides"])
        self._renumber()

    def _reference_speed(self) -> float:
        """Return the size of the reference speed at the start [rad/s]."""
        names = [state.name for state in self.library.manifest.states]
        free = float(self.at.x[names.index("reference.speed")]) if "reference.speed" in names else 0.0
        return abs(free if self.held is None else self.held)

    def phases(self, z: Vector, signals: Vector) -> Phases:
        """Return the mesh phases of a state under some load signals."""
        s = np.concatenate([np.zeros(len(self.library.manifest.levels)), signals])
        tau, rate, share = self.phase_kernel(self.frame.origin + self.frame.scale * z, s, self.p)
        return Phases(tau.copy(), rate.copy(), share.copy())

    def energy(self, z: Vector, cells: Cells, signals: Vector) -> float:
        """Return kinetic and potential energy [J], weight included."""
        s = np.concatenate([levels_of(cells), signals])
        balance = self.energy_kernel(self.frame.origin + self.frame.scale * z, s, self.p)[0]
        return float(balance[0] + balance[1] + balance[2])

    def segment(self, left: float) -> tuple[float, Vector, Vector]:
        """Integrate to the next switching instant or knot, ``left`` seconds at most; return duration, path, levels.

        Where nothing switches or bends, the last block of samples is finished even beyond the end.
        """
        self._rebase()
        signals, slope = self.signals.at(self.time), self.signals.rate(self.time)
        now, knot = self.phases(self.z, signals), self.signals.next_knot(self.time)
        most = min(self.longest, knot - self.time, left if isinstance(self.nodes, Chebyshev) else self.longest)
        gain = np.zeros_like(now.rate)
        self._turn_back(now)
        if self.speed is not None:
            gain = (self.phases(self.z, signals + slope * most).rate - now.rate) / most
            self._stand(now, gain, signals)
        levels, duration = levels_of(self.cells), most
        if not self.stepper.finds_borders:
            duration = min(time_to_border(self.cells, now, gain), most)
        self.watch.cells = self.cells
        if duration <= 0:
            raise RuntimeError("two switching instants of one mesh fall together; check its contact ratio")
        s = np.concatenate([levels, signals])
        self._settle(s)
        arc, cells, sides = self._to_border(duration, now, s, slope)
        times, duration = arc.duration * self.nodes.points, arc.duration
        self.extremes.note(
            self.frame.origin + self.frame.scale * arc.z, self._along(s, times, slope), self.p, self.time + times
        )
        self._change(sides)
        self._pass(duration, knot)
        self.work, self.z, self.fresh = self.work + float(arc.work[-1]), arc.z[-1].copy(), False
        self._switch(cells, signals + slope * duration)
        return duration, arc.z, levels

    def _to_border(self, duration: float, now: Phases, s: Vector, slope: Vector) -> tuple[Arc, Cells, Sides]:
        """Integrate for a duration, or to the first border if that comes before; return cells and sides after it."""
        aimed, aims = False, 0
        for _ in range(TRIALS):
            arc = self._arc(duration, s, slope)
            if not self._resolved(arc):
                duration, aimed = self.longest, False
                continue
            along = self._along(s, arc.duration * self.nodes.points, slope)
            after = self.phases(arc.z[-1], self._signals_after(arc.duration, s, slope))
            cells, part = crossed(self.cells, now, after)
            if aimed:
                correction, sides = self.regimes.end(arc, along, aims)
                aims += 1
                if correction == 0:
                    break
                duration *= 1 + correction
                continue
            part = min(part, self._standstill(arc))
            first, sides = self.regimes.cross(arc, along)
            if (sides != self.regimes.sides).any():
                self._change(sides)
                continue
            if min(part, first) == 1.0:
                if arc.duration < duration:  # the engine has met a border
                    _, sides = self.regimes.end(arc, along, TRIALS)
                break
            aimed = first < part
            duration = arc.duration * min(part, first)  # go back to the segment's start with a shorter one
        else:
            raise RuntimeError(f"a switching instant could not be located in {TRIALS} trials")
        return arc, cells, sides

    def _standstill(self, arc: Arc) -> float:
        """Return the part of an arc before a free train turns back, so that it comes and goes in arcs of their own."""
        if self.free is None or not len(self.cells):
            return 1.0
        speed = self.frame.origin[self.free] + self.frame.scale[self.free] * arc.z[:, self.free]
        still = max(STANDING * float(np.abs(speed).max()), self.rtol * self.frame.scale[self.free])
        back = np.flatnonzero((speed[0] * speed < 0) & (np.abs(speed) > still))
        if not len(back) or abs(speed[0]) <= still:
            return 1.0
        before, after = back[0] - 1, back[0]
        low, high = self.nodes.points[before], self.nodes.points[after]
        return float(low + (high - low) * speed[before] / (speed[before] - speed[after]))

    def _turn_back(self, now: Phases) -> None:
        """Note the cells where a free train has turned back."""
        heading = np.sign(now.rate)
        if self.free is not None and (heading * self.heading < 0).any():
            self.expected += self._passed(now)
            self.last_turn = self._counted(now)
        self.heading = np.where(heading == 0, self.heading, heading)

    def _arc(self, duration: float, s: Vector, slope: Vector) -> Arc:
        """Integrate for a duration with levels and sides held."""
        arc = self.stepper.advance(self.z, duration, self.frame.origin, s, slope)
        times = arc.duration * self.nodes.points
        return Arc(arc.duration, self._on_course(arc.z, times, s[len(self.cells) :], slope), arc.work)

    def _settle(self, s: Vector) -> None:
        """Bring the regimes in line with the state, and tell the stepper which sides hold."""
        self._change(self.regimes.settled(self.z, s))

    def _change(self, sides: Sides) -> None:
        """Go over to other sides of borders."""
        self.stepper.counts.regimes += int((sides != self.regimes.sides).sum())
        self.regimes.sides = sides
        self._renumber()

    def _renumber(self) -> None:
        """Put the sides that hold into the parameters, and hand these on."""
        self.regimes.hold(self.p)
        self.stepper.renumber(self.p)

    def _along(self, s: Vector, times: Vector, slope: Vector) -> Vector:
        """Return levels and signals at times after the start of an arc, shape (times, n_s)."""
        return s + np.outer(times, self._rates(slope))

    def _pass(self, duration: float, knot: float) -> None:
        """Let time pass; what a late time rounds off is kept for the next (Kahan's sum), a knot is met exactly."""
        before, due = self.time, duration + self.unpassed
        met = duration == knot - before
        self.time = knot if met else before + due
        self.unpassed = 0.0 if met else due - (self.time - before)

    def _rebase(self) -> None:
        """Take whole turns off the reference angle, and whole periods off all that follows it."""
        angle, scale = self.angle, self.frame.scale
        more = 0 if angle < 0 else self.clocks.turns_in(float(self.frame.origin[angle] + scale[angle] * self.z[angle]))
        if not more:
            return
        meshes, turns = self.library.manifest.levels, self.turns + more
        gone = 2 * (self.clocks.cycles(meshes, turns) - self.clocks.cycles(meshes, self.turns))
        self.cells, self.last_turn, self.turns = self.cells - gone, self.last_turn - gone, turns
        self.z[angle] -= TURN * more / scale[angle]
        self.p[:] = self.clocks.parameters(turns)
        self._renumber()

    def _resolved(self, arc: Arc) -> bool:
        """Say whether a segment's nodes resolve its motion to the tolerance; longer and shorter ones follow from it.

        What a polynomial through the nodes leaves out is about as large as its last terms.
        """
        if not isinstance(self.nodes, Chebyshev):
            return True
        left_out = np.abs(self.nodes.last_terms @ arc.z).max(axis=0)
        error = float((left_out / np.maximum(np.abs(arc.z).max(axis=0), 1.0)).max()) / self.unresolved
        factor = float(np.clip((0.1 / max(error, 1e-12)) ** (1 / len(self.nodes.points)), 0.25, 4.0))
        resolved = error <= 1.0 or arc.duration <= self.shortest
        if not resolved:
            factor = min(factor, 0.5)
        if not resolved or arc.duration > 0.99 * self.longest:
            self.longest = float(np.clip(factor * arc.duration, self.shortest, LONGEST * self.shortest))
            if self.fresh:
                self.first = self.longest
        return resolved

    def _signals_after(self, duration: float, s: Vector, slope: Vector) -> Vector:
        """Return the signals after a duration; at a knot the table's own, so that a standstill is one to the bit."""
        knot = self.signals.next_knot(self.time)
        met = duration == knot - self.time
        return self.signals.before(knot) if met else np.asarray(s[len(self.cells) :] + slope * duration)

    def _rates(self, slope: Vector) -> Vector:
        """Return the rates of levels and signals."""
        return np.concatenate([np.zeros(len(self.library.manifest.levels)), slope])

    def _on_course(self, path: Vector, times: Vector, signals: Vector, slope: Vector) -> Vector:
        """Put in the reference angle, which a held speed makes known: no tolerance then moves a switching."""
        speed, angle = self.speed, self.angle
        if speed is not None or self.held is not None:
            turned = signals[speed] * times + slope[speed] * times**2 / 2 if self.held is None else self.held * times
            path[:, angle] = path[0, angle] + turned / self.frame.scale[angle]
        return path

    def _stand(self, now: Phases, gain: Vector, signals: Vector) -> None:
        """At a standstill, note the cells, and leave those at whose border it stands in the direction ahead."""
        if now.rate.any():
            return
        self.expected += self._passed(now)
        self.last_turn = self._counted(now)
        ahead = Phases(now.tau, gain, now.share)
        cells, _ = crossed(self.cells, ahead, ahead)
        self.expected += int(np.abs(cells - self.cells).sum())
        self.last_turn = self.last_turn + cells - self.cells
        self._switch(cells, signals)

    def _counted(self, now: Phases) -> Cells:
        """Return the cells by kinematics; on a border that of the march, whether or not it has left its last one."""
        beside = np.minimum(
            np.abs(now.tau - lower(self.cells, now.share)), np.abs(now.tau - upper(self.cells, now.share))
        )
        turned = (now.rate == 0) | (self.free is not None)
        return np.where(turned & (beside <= at_border(now)), self.cells, cells_of(now))

    def _passed(self, now: Phases) -> int:
        """Return the switchings since the last standstill by kinematics."""
        return int(np.abs(self._counted(now) - self.last_turn).sum())

    def expected_events(self) -> int:
        """Return the switchings that kinematics calls for: borders between the phases where the train turned back."""
        return self.expected + self._passed(self.phases(self.z, self.signals.at(self.time)))

    def _switch(self, cells: Cells, signals: Vector) -> None:
        """Go over to other cells, and book what the stiffness jumps put in."""
        if (cells != self.cells).any():
            before = self.energy(self.z, self.cells, signals)
            self.jump_energy += self.energy(self.z, cells, signals) - before
            self.stepper.counts.events += int(np.abs(cells - self.cells).sum())
            self.cells = cells
            self.longest, self.fresh = min(self.first, self.longest), True


def held_speed(library: Library, p: Vector) -> float | None:
    """Return the reference speed [rad/s] where it is one number that is held."""
    names = [name for name, _ in library.manifest.parameters]
    held = library.manifest.reference == "speed" and "reference.speed" in names
    return float(p[names.index("reference.speed")]) if held else None


def _plain(value: NDArray[np.generic]) -> Any:  # noqa: ANN401
    """Return an array as it was before it was kept: a number, or an array of its own."""
    return value.copy() if value.ndim else value.item()
