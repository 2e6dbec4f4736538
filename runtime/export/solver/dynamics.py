"""Right-hand side and Jacobian as functions of time and state, for any solver."""

from collections.abc import Mapping
from ctypes import ArgumentError
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from ltcgear.generated.contract import HELD
from ltcgear.generated.errors import LtcgearError
from numpy.typing import ArrayLike, NDArray

from ...model.contact_levels import AT_BORDER, Phases, cells_of
from ...model.equilibrium import find_equilibrium
from ...model.library import Library
from ...model.load_tables import Pairs, Signals
from ...model.operating_point import OperatingPoint
from ...model.parameter_values import read_numbers, read_time
from ...results.select import split_output
from .c_binding import Callee

if TYPE_CHECKING:
    from scipy.sparse import csc_array

Vector = NDArray[np.float64]

ON_BORDER = 1e-8
"""Distance from an event that counts as on it, over the change of its indicator by usual vibrations."""
INSTANT, ROUNDED = 1e-13, 256 * np.finfo(float).eps
"""Time [s], and share of the elapsed time, within which an event counts as reached: a solver's root tolerance."""
BRIEF, STEPS = 1e-2, 4
"""Steps, as phase angles of the fastest vibration [rad], that show whether an event is approached."""
NAMES = {"x": "Dynamics.states", "p": "Dynamics.parameters"}
"""Where a user reads what the numbers of an argument are."""


class Border:
    """An event for ``solve_ivp``: the motion leaves the held contact state. It ends the integration.

    Attributes
    ----------
    name
        The border's: its parameter that holds a side, or the mesh whose teeth are in contact.
    """

    terminal, direction = True, -1.0

    def __init__(self, dynamics: "Dynamics", place: int, name: str) -> None:
        self._dynamics, self._place, self.name = dynamics, place, name

    def __call__(self, t: float, x: Vector, p: Vector | None = None) -> float:
        """Return the event function at a state, positive on the held side."""
        return float(self._dynamics.borders(t, x, p)[self._place])


class Dynamics:
    """Equations of motion of a built model, xdot = f(t, x, p), for a solver of your own.

    The load signals follow the model's tables at time t. Mesh levels (how many tooth pairs are in contact) and regimes
    (teeth that separate, clearances that close) follow the state x: the right-hand side or its slope jumps where they
    change. ``hold`` fixes them, so that a solver sees smooth functions only, and returns when to hold again.

    An object belongs to one thread at a time, since its calls share memory; make one for each thread. Making it,
    ``x0``, ``sizes`` and the first ``hold`` use CasADi, which serves one thread only; all other calls let other threads
    run.

    Parameters
    ----------
    library
        A built model.
    values
        Parameter name -> value in SI: ``model.values()``.
    tables
        Table name -> rows of time [s] and value in SI: ``model.tables``.

    Attributes
    ----------
    p
        Parameters, shape (n_p,): what ``p`` is where a call leaves it out.
    states, parameters, output_names
        Names in the order of x, p and the columns of ``outputs``; the latter as QUANTITY:ITEM.
    events
        For ``solve_ivp(events=...)``: one a border of a regime, and where the reference speed is free two a mesh,
        since kinematics does not give their switching instants.

    Raises
    ------
    LtcgearError
        If a parameter or a table is missing or unknown, or a number is none that the model can take.
    CompileError
        If there is no compiler.
    """

    def __init__(
        self, library: Library, values: Mapping[str, float], tables: Mapping[str, Pairs] | None = None
    ) -> None:
        manifest = library.manifest
        self.library, self._tables = library, dict(tables or {})
        self.states = tuple(state.name for state in manifest.states)
        self.parameters = tuple(name for name, _ in manifest.parameters)
        self.output_names = tuple(f"{r.quantity}:{r.item}" if r.item else r.quantity for r in manifest.reports)
        self._given = library.parameters(values)
        self.p = self._given.copy()
        self._signals = Signals(manifest.signals, self._tables)
        self._callee = callee = Callee()
        self._state, self._address = callee.state, callee.address
        self._arrays, self._engine = callee.arrays, callee.engine
        self._lay_out()
        self._bind()
        self._x, self._p = (memoryview(self._arrays[name].data) for name in "xp")
        self._rate, self._run = self._arrays["rate"], self._engine.ltcgear_dynamics_rhs
        names = [*manifest.holds, *(2 * manifest.levels if self._state.free else ())]
        self.events = tuple(Border(self, place, name) for place, name in enumerate(names))

    def __reduce__(self) -> Any:  # noqa: ANN401
        """Refuse to be copied: a copy would share the memory that the C works in."""
        raise LtcgearError("Dynamics cannot be copied or sent to a process; make another: Dynamics(library, values)")

    def _lay_out(self) -> None:
        """Set the C's sizes, constants and work arrays."""
        state, share, manifest = self._state, self._callee.share, self.library.manifest
        n, meshes, holds, signals = (
            len(part) for part in (manifest.states, manifest.levels, manifest.holds, manifest.signals)
        )
        state.n, state.n_levels, state.n_holds, state.n_signals = n, meshes, holds, signals
        state.n_outputs, state.held_value = len(manifest.reports), HELD
        state.free = "reference.speed" in self.states
        tables = self._signals.tables
        share("first", np.cumsum([0, *(len(time) for time, _ in tables)]))
        share("times", np.concatenate([np.zeros(0), *(time for time, _ in tables)]))
        share("values", np.concatenate([np.zeros(0), *(value for _, value in tables)]))
        share("sloping", self._signals.sloping)
        share("hold_index", [self.parameters.index(hold) for hold in manifest.holds])
        rows, columns = map(np.array, self.library.functions["jac_rhs"].sparsity_out(0).get_triplet())
        state.n_entries = len(rows)
        share("place_of", rows * n + columns)
        sizes: dict[str, Any] = {
            "x": n, "p": len(self.p), "rate": n, "s": meshes + signals, "course": (3, meshes), "cells": meshes,
            "signals": signals, "slope": signals, "sides": holds, "distances": holds + 2 * meshes, "matrix": (n, n),
            "entries": len(rows),
        }  # fmt: skip
        for name, size in sizes.items():
            share(name, np.zeros(size))

    def _bind(self) -> None:
        """Give the C the model's functions and where their results go."""
        rate, entries, distances = (self._arrays[name].ctypes.data for name in ("rate", "entries", "distances"))
        phases = [row.ctypes.data for row in self._arrays["course"]]
        targets = {"rhs": [rate], "jac_rhs": [entries], "phases": phases, "borders": [distances], "outputs": []}
        for name, results in targets.items():
            self._callee.bind(name, self.library, results)

    # --- what solvers call

    def rhs(self, t: float, x: Vector, p: Vector | None = None) -> Vector:
        """Return the rates of the states.

        Parameters
        ----------
        t
            Time [s].
        x
            States, shape (n,), in SI.
        p
            Parameters, shape (n_p,), in SI; ``self.p`` where left out.

        Returns
        -------
        numpy.ndarray
            Shape (n,), a new array.

        Raises
        ------
        LtcgearError
            If a shape is wrong, or what is given is not real numbers.
        """
        try:
            # A memory view takes no other shape or type than its own: there is nothing left to check.
            self._x[:] = x  # type: ignore[call-overload]
            self._p[:] = self.p if p is None else p  # type: ignore[call-overload]
            failed = self._run(self._address, t)
        except (TypeError, ValueError, BufferError, NotImplementedError, ArgumentError):
            failed = 1
        if failed:
            self._call("rhs", t, x, p)
        return self._rate.copy()

    def jac(self, t: float, x: Vector, p: Vector | None = None) -> Vector:
        """Return d rhs / d x as a full matrix, shape (n, n), a new array; levels count as constant."""
        self._call("jac", t, x, p)
        return self._arrays["matrix"].copy()

    def jac_sparse(self, t: float, x: Vector, p: Vector | None = None) -> "csc_array":
        """Return d rhs / d x as a sparse matrix, whose pattern is always the same (``pattern``)."""
        from scipy.sparse import csc_array

        self._call("jac", t, x, p)
        return csc_array((self._arrays["entries"].copy(), *self.pattern), shape=2 * (len(self.states),))

    @cached_property
    def pattern(self) -> tuple[NDArray[np.int32], NDArray[np.int32]]:
        """Return where the Jacobian may be other than zero: row indices, and where each column starts in them."""
        sparsity = self.library.functions["jac_rhs"].sparsity_out(0)
        return np.array(sparsity.row(), dtype=np.int32), np.array(sparsity.colind(), dtype=np.int32)

    def outputs(self, t: ArrayLike, x: ArrayLike, p: Vector | None = None) -> Vector:
        """Return all outputs at one or many times.

        Parameters
        ----------
        t, x
            Times [s] and states, shapes (m,) and (m, n), or one of them. ``solve_ivp`` gives ``y.T``.
        p
            Parameters.

        Returns
        -------
        numpy.ndarray
            Shape (m, n_y) in the order of ``output_names``, or (n_y,); SI.
        """
        states, times = read_numbers(x, "x"), read_numbers(t, "t")
        n = len(self.states)
        if states.ndim not in (1, 2) or states.shape != (*times.shape, n):
            raise LtcgearError(
                f"t and x: shapes {times.shape} and {states.shape}; there must be m times and m states of {n} numbers, "
                f"shapes (m,) and (m, {n}); from solve_ivp take y.T"
            )
        self._put("p", self.p if p is None else p)
        out = np.empty((*times.shape, self._state.n_outputs))
        places = (array.ctypes.data for array in (times, states, out))
        if self._engine.ltcgear_dynamics_outputs(self._address, times.size, *places):
            raise LtcgearError("the model's outputs failed")
        return out

    def columns(self, quantity: str) -> list[int]:
        """Return the columns of ``outputs`` that hold a quantity, as ``mesh_force``; or one item's, QUANTITY:ITEM."""
        found = [i for i, name in enumerate(self.output_names) if quantity in (name, split_output(name)[0])]
        if not found:
            known = dict.fromkeys(split_output(name)[0] for name in self.output_names)
            raise LtcgearError(f"no output {quantity!r}; there are {', '.join(known)}")
        return found

    # --- where to start, and where to start again

    @cached_property
    def _point(self) -> OperatingPoint:
        at = find_equilibrium(self.library, self._given, tables=self._tables)
        return OperatingPoint(self.library, self._given, at)

    @property
    def x0(self) -> Vector:
        """Return the loaded equilibrium for ``values``, where ``simulate`` starts; SolverError where there is none."""
        return self._point.at.x.copy()

    @property
    def sizes(self) -> Vector:
        """Return the size of vibrations in each state, shape (n,): ``atol = rtol * sizes`` weighs all alike."""
        return self._point.scale

    def hold(self, t: float, x: Vector, p: Vector | None = None) -> float:
        """Hold levels, contact states and the slopes of load signals from now on.

        Until the time that is returned, or until one of ``events`` falls to zero if that is earlier, the functions are
        smooth and are those of the model. Integrate up to there, hold again and restart. At an event the side
        counts to which the motion goes.

        Returns
        -------
        float
            The next known time [s] of a switching or of a knot in a table, infinite if there is none.
        """
        state, arrays, signals = self._state, self._arrays, self._signals
        t = read_time(t)
        self._take(x, p)
        if not (np.isfinite(t) and np.isfinite(arrays["x"]).all()):
            raise LtcgearError("hold: time and state must be finite numbers; the integration has gone astray before")
        arrays["signals"][:], arrays["slope"][:], state.base = signals.at(t), signals.rate(t), t
        state.held = 1
        tau, rate, share = self._course(t)
        gain = self._course(t + 1.0)[1] - rate if arrays["slope"].any() else 0.0 * rate
        arrays["cells"][:] = cells_of(Phases(tau, np.where(rate != 0, rate, gain), share))
        self._choose_sides(t)
        if self.events:
            _ = self._slack  # by CasADi, so not when the first event is asked for
        until = float("inf")
        if not state.free:
            now = np.concatenate([tau, rate, share])
            places = (array.ctypes.data for array in (arrays["cells"], now, gain))
            until = t + self._engine.ltcgear_time_to_border(state.n_levels, *places)
        return float(min(max(until, np.nextafter(t, np.inf)), signals.next_knot(t)))

    def release(self) -> None:
        """Let levels and regimes follow the state again, load signals their tables."""
        self._state.held = self._state.sided = 0

    def borders(self, t: float, x: Vector, p: Vector | None = None) -> Vector:
        """Return the event functions of ``events`` at a state, positive on the held side, shape (events,)."""
        if not self._state.held:
            raise LtcgearError("borders are those of what is held: call hold(t, x) first")
        slack = self._slack  # found with the C's own arrays, so before the state is given
        self._call("borders", t, x, p)
        return np.asarray(self._arrays["distances"][: len(self.events)] + slack)

    def _choose_sides(self, t: float) -> None:
        """Choose the contact states: the last ones, unless the state is beyond an event, or on it and moving on."""
        state, arrays = self._state, self._arrays
        if not state.n_holds:
            return
        if not state.sided:
            arrays["sides"][:] = self._indicators(t) > 0
            state.sided = 1
        signed, slope = self._indicators(t), self._indicator_rates(t)
        # A root in time is found no better than times are told apart, however fast it is crossed.
        near = np.maximum(2 * self._slack[: state.n_holds], np.abs(slope) * (INSTANT + ROUNDED * abs(t)))
        arrays["sides"][(signed < -near) | ((signed <= near) & (slope < 0))] ^= True

    def _indicators(self, t: float) -> Vector:
        """Return the indicators of regimes at the state that was given last."""
        self._engine.ltcgear_dynamics_borders(self._address, t)
        return self._arrays["distances"][: self._state.n_holds].copy()

    def _indicator_rates(self, t: float) -> Vector:
        """Return the rates of the indicators with the sides that are held, by a difference over a short time.

        The state is advanced by midpoint steps: a motion from rest under a load that rises leaves with the third power
        of time.
        """
        x, first, step = self._arrays["x"], self._indicators(t), BRIEF / self._point.fastest
        start = x.copy()
        for k in range(STEPS):
            before = x.copy()
            for part in (0.5, 1.0):
                self._run(self._address, t + (k + part - 0.5) * step)
                x[:] = before + part * step * self._rate
        ahead = self._indicators(t + STEPS * step)
        x[:] = start
        return np.asarray((ahead - first) / (STEPS * step))

    @cached_property
    def _slack(self) -> Vector:
        """Return how far the state is beyond an event: what rests on it does not cross it."""
        x, t, moved = self._arrays["x"], float(self._state.base), []
        start, first = x.copy(), self._indicators(t)
        for i, scale in enumerate(self.sizes):
            x[i] += scale
            moved.append(np.abs(self._indicators(t) - first))
            x[i] = start[i]
        slack = ON_BORDER * np.max(moved, axis=0)
        return np.concatenate([slack, np.full(len(self.events) - len(slack), AT_BORDER / 2)])

    def _course(self, t: float) -> Vector:
        """Return tau [cycles], rate [1/s] and share of the mesh phases, shape (3, meshes)."""
        self._engine.ltcgear_dynamics_course(self._address, t)
        return self._arrays["course"].copy()

    # --- what is given

    def _call(self, name: str, t: float, x: Vector, p: Vector | None) -> None:
        """Evaluate what the C has by a name."""
        self._take(x, p)
        if getattr(self._engine, f"ltcgear_dynamics_{name}")(self._address, read_time(t)):
            raise LtcgearError(f"the model's {name} failed")

    def _take(self, x: Vector, p: Vector | None) -> None:
        """Copy state and parameters."""
        self._put("x", x)
        self._put("p", self.p if p is None else p)

    def _put(self, name: str, given: Vector) -> None:
        """Copy an argument, once it has the right shape and is of real numbers."""
        array, target = read_numbers(given, name), self._arrays[name]
        if array.shape != target.shape:
            raise LtcgearError(f"{name}: shape {array.shape}, must be {target.shape}; see {NAMES[name]}")
        target[:] = array
