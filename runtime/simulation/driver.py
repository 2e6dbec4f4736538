"""Driver of an integration: segments of smooth motion between switching instants.

Segments are integrated in C (``model/c/march.c``); this module starts them, and stops at the knots of load tables and
after whole turns of the reference.
"""

from dataclasses import asdict, replace
from functools import partial
from math import ceil
from typing import Any

import numpy as np
from ltcgear.generated.contract import HELD
from numpy.typing import NDArray

from ..model.contact_levels import Cells, Phases, cells_of, expected_switchings, levels_of
from ..model.cstruct import FAULTS, FINE, NAMES, STAGES, STOPPED, Native
from ..model.function import Kernel
from ..model.library import Library
from ..model.load_tables import Signals
from ..model.operating_point import OperatingPoint
from ..model.phase_wrapping import TURN, Clocks
from ..results.checkpoint import Snapshot
from ..results.peaks import MeshExtremes
from .contact_events import EventFunctions, Regimes
from .dense_output import Chebyshev, Nodes, Uniform
from .failure import explain, last_state
from .methods import stepper
from .methods.registry import Method
from .methods.stepper import SegmentProblem, Stepper
from .quadrature import MOST, lobatto_rules
from .run_settings import RunSettings
from .smooth_arc import Frame
from .trajectory import Counts

Vector = NDArray[np.float64]
MOST_TURNS = 16
"""Turns of the reference in a block of samples, after which whole turns are subtracted from its angle."""
WIDEST = 1000.0
"""Largest phase angle [rad] of the fastest mode between two nodes (explicit methods) without switching."""
FINEST = 1e-9
"""Interpolation error allowed between nodes, whatever the tolerance: how well they resolve the fastest mode."""
SHORTEST = 1 / 64
"""Factor by which a segment may be shorter, where stiffness or loads vary faster than any mode."""
LONGEST = 4096
"""Factor by which a segment may be longer than one that resolves the fastest mode: 12 halvings undo it."""
BLOCK = 256
"""Samples in a block without switchings or contact events."""
APART, MOST_FINER = 1.2, 64
"""Least nodes of such a block per period of the fastest mode where points are taken; most nodes per sample."""
WEIGHTS = 80 * np.pi
"""Phase angle [rad] that points resolve over a run at least: ten times that of the window sin(pi s)^4 of its half."""
POINT_ROOM = 4096
"""Capacity of the buffer of points; no segment adds more than half of it."""
CAPACITY = 2048
"""Capacity of the buffer of samples; no segment holds more than half of it."""


class March:
    """An integration in progress.

    Parameters
    ----------
    point
        The operating point where the motion starts.
    settings
        Method, tolerance, time and sampling rate.
    signals
        The load signals.
    dense
        Whether all segments have nodes for interpolation, even without switchings or contact events.
    passing
        Frequency [rad/s] that points of the motion resolve (``model/c/points.c``); None takes no points.

    Attributes
    ----------
    native
        The structure shared with the C.
    turns
        Whole turns subtracted from the reference angle.
    extremes
        Smallest and largest mesh forces.

    Raises
    ------
    CompileError
        If there is no compiler.
    """

    def __init__(
        self, point: OperatingPoint, settings: RunSettings, signals: Signals, *, dense: bool = False,
        passing: float | None = None,
    ) -> None:  # fmt: skip
        library = self.library = point.library
        self.signals, self.rtol = signals, settings.rtol
        samples, rate = settings.samples, settings.sampling_rate
        names = [state.name for state in library.manifest.states]
        self.angle = names.index("reference.angle") if "reference.angle" in names else -1
        self.held, self.clocks = held_speed(library, point.p), Clocks(library.manifest, point.p)
        self.turns = 0 if self.angle < 0 else self.clocks.turns_in(float(point.at.x[self.angle]))
        self.point = self._less_turns(point)
        self.native = native = Native()
        self.state = native.state
        self.p = native.share("p", self.clocks.parameters(self.turns))
        self.frame = Frame(self.point.at.x.copy(), self.point.scale)
        self.z = native.share("z", np.zeros(len(self.frame.origin)))
        self._lay_out(chosen := settings.integrator, samples, rate, dense, passing)
        self._set_levels(names)
        self._set_regimes(signals.at(0.0), self.angle if self.angle >= 0 and "reference.speed" not in names else None)
        self._set_room(samples, rate)
        self._bind()
        events = EventFunctions(self.regimes, self.phase_kernel, self.p, self.cells)
        self.stepper = chosen.make(
            SegmentProblem(library, self.p, self.rtol, self.frame, self.nodes.points[1:], events)
        )
        if self.stepper is not None:
            self.state.finds_borders = self.stepper.finds_borders
            native.call_back(partial(self._advance, self.stepper))
        self.broken: BaseException | None = None
        self.first_energy = self.energy(self.z, self.cells, signals.at(0.0))

    def _less_turns(self, point: OperatingPoint) -> OperatingPoint:
        """Return the point with whole turns taken off the reference angle; itself where there are none."""
        if not self.turns:
            return point
        x = point.at.x.copy()
        x[self.angle] -= TURN * self.turns
        return replace(point, p=self.clocks.parameters(self.turns), at=replace(point.at, x=x))

    def _lay_out(self, method: Method, samples: int, rate: float, dense: bool, passing: float | None) -> None:
        """Choose nodes and longest segment [s]: blocks of samples without switchings or contact events, else Chebyshev.

        17 nodes over 8 rad of the fastest mode, or 25 over 16 rad, resolve any mode to 1e-9. Segments start with that
        length, grow where the fastest modes are at rest, and shrink where stiffness or loads vary faster. Blocks have
        equal length; nodes are added between samples that are far apart, for explicit methods, which would exceed
        their number of steps, and where points are taken, which are at the nodes.
        """
        state, share, manifest = self.state, self.native.share, self.library.manifest
        quickest = self.point.fastest
        self.nodes: Nodes
        if dense or manifest.levels or manifest.signals or manifest.holds:
            count, turn = (24, 16.0) if method.multistep else (16, 8.0)
            self.nodes = nodes = Chebyshev(count)
            state.longest = min(turn / quickest, CAPACITY / 2 / rate)
            state.widest = min(LONGEST * state.longest, CAPACITY / 2 / rate)
            share("last_terms", nodes.last_terms)
            share("weights", nodes.weights)
        else:
            finer = max(ceil(quickest / rate / WIDEST), 1) if method.explicit else 1
            if passing is not None:
                finer = max(finer, min(ceil((APART * quickest + passing) / (TURN * rate)), MOST_FINER))
            turning = self._reference_speed() / (MOST_TURNS * TURN)
            block = BLOCK * min(finer, 4)
            most = max(1, min(block, int(rate / turning) * finer if turning else block))
            block = ceil(samples * finer / ceil(samples * finer / most))
            self.nodes, state.longest, state.uniform = Uniform(block), block / finer / rate, 1
        state.shortest, state.first = SHORTEST * state.longest, state.longest
        state.rtol, state.unresolved = self.rtol, max(method.unresolved * self.rtol, FINEST)
        state.fresh = 1
        state.n_nodes = len(share("points", self.nodes.points))
        self._set_points(quickest, None if passing is None else max(passing, WEIGHTS * rate / samples))

    def _set_points(self, quickest: float, passing: float | None) -> None:
        """Choose points of segments: the frequency that they resolve [rad/s], the window of statistics, the rules."""
        state, share, rules = self.state, self.native.share, lobatto_rules()
        if passing is not None:
            state.turning, state.passing, state.most_points = quickest, passing, MOST
            state.point_room = POINT_ROOM
        for name, values in (("at", rules.at), ("weight", rules.weight), ("motion", rules.motion)):
            share(f"rule_{name}", values)
        share("rule_filter", rules.filtered)

    def _set_levels(self, names: list[str]) -> None:
        """Set the cells of the mesh phases at the start, and what may turn them back."""
        state, share, kinds = self.state, self.native.share, self.library.manifest.signals
        state.angle, state.held, state.held_speed = self.angle, self.held is not None, self.held or 0.0
        state.speed = next((i for i, signal in enumerate(kinds) if signal.name == "reference.speed"), -1)
        state.free = names.index("reference.speed") if "reference.speed" in names else -1
        self.phase_kernel = Kernel(self.library.functions["phases"])
        self.energy_kernel = Kernel(self.library.functions["energy"])
        self.cells: Cells = share("cells", cells_of(self.phases(self.z, self.signals.at(0.0))))
        share("last_turn", self.cells)
        share("heading", np.zeros(len(self.cells)))

    def _set_regimes(self, start: Vector, known: int | None) -> None:
        """Set the states of the contacts at the start."""
        share, s = self.native.share, np.concatenate([levels_of(self.cells), start])
        self.regimes = Regimes(self.library, self.p, self.frame, self.rtol, s, known)
        self.regimes.sides = share("sides", self.regimes.sides)
        share("hold_index", self.regimes.index)
        share("error", self.regimes.error)
        share("slack", self.regimes.slack)
        share("fine", self.nodes.matrix(np.arange(FINE + 1) / FINE) if len(self.regimes.index) else np.zeros(0))
        self.state.held_value = HELD

    def _set_room(self, samples: int, rate: float) -> None:
        """Set the C's sizes and work arrays."""
        state, share, manifest = self.state, self.native.share, self.library.manifest
        n, meshes, holds, nodes = len(self.z), len(manifest.levels), len(manifest.holds), len(self.nodes.points)
        forces = [i for i, report in enumerate(manifest.reports) if report.quantity == "mesh_force"]
        state.n, state.n_levels, state.n_signals = n, meshes, len(manifest.signals)
        state.n_holds, state.n_forces = holds, len(forces)
        state.capacity, state.last, state.sampling, state.end = CAPACITY, samples, rate, samples / rate
        state.done, state.most_steps = 1, stepper.MOST_STEPS
        share("origin", self.frame.origin)
        share("scale", self.frame.scale)
        lowest, steady = np.full(len(forces), np.inf), np.full((2, len(forces)), np.nan)
        state.span_from = state.end / 2
        self.extremes = MeshExtremes(share("lowest", lowest), share("steady", steady), state.span_from)
        sizes: dict[str, Any] = {
            **dict.fromkeys(("zeros", "x", "y", "y_after", "trial", "rate", "z_near", "z_far"), n),
            **dict.fromkeys(("now", "after", "ahead"), 3 * meshes),
            **dict.fromkeys(("gain", "changed", "arc_cells"), meshes),
            **dict.fromkeys(("s", "s_now", "s_end"), meshes + state.n_signals),
            **dict.fromkeys(("signals", "signals_knot", "slope", "signals_end"), state.n_signals),
            **dict.fromkeys(("g_now", "g_start", "g_slope", "g_noise", "new_sides", "arc_sides"), holds),
            **{"node_values": nodes * holds, "fine_values": (FINE + 1) * holds, "node_work": nodes},
            **{"stages": (STAGES, n), "power": STAGES, "balance": 5, "path": (nodes, n)},
            **dict.fromkeys(("forces", "arc_lowest"), len(forces)),
            **dict.fromkeys(("seen_forces", "arc_steady"), (2, len(forces))),
            "seen_time": 3,
            **dict.fromkeys(("sample_time", "sample_steps"), CAPACITY),
            **{"sample_x": (CAPACITY, n), "sample_levels": (CAPACITY, meshes)},
            **dict.fromkeys(("point_time", "point_weight"), state.point_room),
            **{"point_x": (state.point_room, n), "point_levels": (state.point_room, meshes)},
        }
        for name, size in sizes.items():
            share(name, np.zeros(size))

    def _bind(self) -> None:
        """Give the C the model's functions; where results go that change from call to call, it says itself."""
        for name in ("motion", "phases", "borders"):
            self.native.bind(name, self.library)
        self.native.bind("energy", self.library, [self.native.arrays["balance"].ctypes.data])

    @property
    def time(self) -> float:
        """Return the time reached [s]."""
        return float(self.state.time)

    @property
    def counts(self) -> Counts:
        """Return what it has cost so far."""
        return Counts(**{name: getattr(self.state, name) for name in asdict(Counts())})

    def snapshot(self) -> Snapshot:
        """Return a snapshot from which the integration can be resumed exactly."""
        kept = {name: self.native.value(name) for name in NAMES["kept"]}
        last = 0.0 if self.stepper is None else self.stepper.last
        return kept | {"turns": np.array(self.turns), "stepper.last": np.array(last)}

    def restore(self, kept: Snapshot) -> None:
        """Resume from a snapshot."""
        for name in NAMES["kept"]:
            self.native.assign(name, kept[name])
        self.turns = int(kept["turns"])
        if self.stepper is not None:
            self.stepper.last = float(kept["stepper.last"])
            for name in ("steps", "rhs", "jacobian", "rejected"):
                setattr(self.stepper.counts, name, getattr(self.state, name))

    def _reference_speed(self) -> float:
        """Return the size of the reference speed at the start [rad/s]."""
        names = [state.name for state in self.library.manifest.states]
        free = float(self.point.at.x[names.index("reference.speed")]) if "reference.speed" in names else 0.0
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

    def proceed(self, seconds: float = np.inf, segments: int = 1 << 40) -> None:
        """Integrate until the samples are complete or fill their buffer, the leg ends, or the time slice is used up.

        Raises
        ------
        RuntimeError
            If a segment cannot be integrated; the state is that at the end of the last one that could.
        """
        self._begin_leg()
        fault = self.native.march(segments, seconds)
        broken, self.broken = self.broken, None
        if broken is not None:
            raise broken
        if fault == STOPPED:  # before the engine's first line, where it was only printed
            raise KeyboardInterrupt
        if fault:
            raise RuntimeError(FAULTS[fault])

    def explain_failure(self) -> str:
        """Say why the motion cannot go on from where it stands, and what to do; empty where that is not plain."""
        library, p, frame = self.library, self.p, self.frame
        s = np.concatenate([levels_of(self.cells), self.signals.at(self.time)])
        slope = np.concatenate([np.zeros(len(self.cells)), self.signals.rate(self.time)])
        rhs, x = Kernel(library.functions["rhs"]), frame.origin + frame.scale * self.z
        x, s = last_state(rhs, p, x, s, slope, self.point.fastest, self.state.longest)
        return explain(library, p, frame, x, s)

    def _begin_leg(self) -> None:
        """Subtract whole turns, and give the C the load signals up to their next knot."""
        self._rebase()
        arrays, state = self.native.arrays, self.state
        state.base, state.knot = self.signals.last_knot(state.time), self.signals.next_knot(state.time)
        arrays["signals"][:] = self.signals.at(state.base)
        arrays["slope"][:] = self.signals.rate(state.base)
        arrays["signals_knot"][:] = self.signals.before(state.knot)

    def _advance(self, engine: Stepper, duration: float) -> None:
        """Let an engine integrate a segment, with levels and sides held; only one that is whole has been reached."""
        arrays = self.native.arrays
        try:
            engine.renumber(self.p)
            arc = engine.advance(self.z, duration, self.frame.origin, arrays["s"], arrays["slope"])
            arrays["path"][:], arrays["node_work"][:] = arc.z, arc.work
            for name in ("steps", "rhs", "jacobian", "rejected"):
                setattr(self.state, name, getattr(engine.counts, name))
            self.state.reached = arc.duration
        except BaseException as error:  # what is raised here must not pass through the C
            self.broken = error

    def _rebase(self) -> None:
        """Subtract whole turns from the reference angle, and whole periods from the phases that follow it."""
        angle, scale = self.angle, self.frame.scale
        more = 0 if angle < 0 else self.clocks.turns_in(float(self.frame.origin[angle] + scale[angle] * self.z[angle]))
        if not more:
            return
        meshes, turns = self.library.manifest.levels, self.turns + more
        gone = 2 * (self.clocks.cycles(meshes, turns) - self.clocks.cycles(meshes, self.turns))
        self.cells -= gone
        self.native.arrays["last_turn"] -= gone
        self.z[angle] -= TURN * more / scale[angle]
        self.p[:] = self.clocks.parameters(turns)
        self.regimes.hold(self.p)
        self.turns = turns

    def expected_events(self) -> int:
        """Return the number of switchings by kinematics, between the phases where the train turned back."""
        now = self.phases(self.z, self.signals.at(self.time))
        free = self.state.free >= 0
        return int(self.state.expected) + expected_switchings(now, self.cells, self.native.arrays["last_turn"], free)


def held_speed(library: Library, p: Vector) -> float | None:
    """Return the reference speed [rad/s] where it is one number that is held."""
    names = [name for name, _ in library.manifest.parameters]
    held = library.manifest.reference == "speed" and "reference.speed" in names
    return float(p[names.index("reference.speed")]) if held else None
