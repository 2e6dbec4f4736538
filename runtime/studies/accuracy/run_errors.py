"""Errors of a run against a reference, in what engineers read: forces, load shares, transmission error, spectra."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...analysis.sharing import group_meshes
from ...model.members import train_of
from ...model.phase_wrapping import Clocks
from ...results.signal_errors import STILL, Signal, compare_signals
from ...simulation.output_reader import outputs_of
from ...simulation.trajectory import Trajectory
from ..force_comparison import Forces, pair_orders, share_loads
from ..selftest.case import Bench

Vector = NDArray[np.float64]
Errors = dict[str, Any]
KINDS = {
    "mesh_force": "mesh force, rms over its vibration",
    "bearing_force": "bearing force, rms over its vibration",
    "transmission_error": "dynamic transmission error, rms over its vibration",
    "load_share": "planets' load share, largest difference",
    "spectrum": "spectrum of mesh forces at mesh orders [dB]",
    "states": "states, rms over the scale of vibrations",
}
MEASURES = ("mesh_force", "transmission_error", "states")
"""Kinds that settings are judged by: the first that a scene has."""
LINES = 1e-2
"""Amplitude over the largest of its mesh down to which a line of the spectrum is compared."""


@dataclass(frozen=True)
class ComparedSamples:
    """What is compared of a run: levels, states less their start over their scale, signals by kind and item.

    A force in a plane is x + iy. ``phases`` are those of the meshes [cycles],
    ``groups`` are of equal meshes; ``reference`` are the states of the reference's own motion.
    """

    levels: Vector
    states: dict[str, Vector]
    signals: dict[str, dict[str, Signal]]
    phases: dict[str, Vector]
    groups: list[list[str]]
    reference: tuple[str, ...] = ()

    def moves(self, size: float) -> bool:
        """Say whether any state moves that far from its start, over its scale; the reference turns without that."""
        return any(np.abs(x).max() > size for name, x in self.states.items() if name not in self.reference)


def take_samples(bench: Bench, path: Trajectory) -> ComparedSamples:
    """Read what is compared from a trajectory."""
    library = bench.library
    values = outputs_of(library, Clocks(library.manifest, bench.p), path)
    read: dict[str, dict[str, Vector]] = {}
    for report, column in zip(library.manifest.reports, values.T, strict=True):
        read.setdefault(report.quantity, {})[report.item] = column
    scaled = (path.x - bench.at.x) / bench.point.scale
    states = {state.name: column for state, column in zip(library.manifest.states, scaled.T, strict=True)}
    train = train_of(library.manifest)
    turning = {name: twist for name, twist in read.get("twist", {}).items() if not train.is_planet(name)}
    signals: dict[str, dict[str, Signal]] = {
        "mesh_force": dict(read.get("mesh_force", {})),
        "bearing_force": _planar(read, "pin_force") | _planar(read, "bearing_force"),
        "transmission_error": dict(turning),  # angle of a member that is no planet against the rigid motion [rad]
    }
    groups = list(group_meshes(signals["mesh_force"], train).values())
    reference = tuple(state.name for state in library.manifest.states if state.is_reference)
    return ComparedSamples(path.levels, states, signals, read.get("mesh_phase", {}), groups, reference)


def _planar(read: Mapping[str, Mapping[str, Vector]], quantity: str) -> dict[str, Signal]:
    """Return forces in a plane as x + iy."""
    x, y = (read.get(f"{quantity}_{axis}", {}) for axis in "xy")
    return {name: x[name] + 1j * y[name] for name in x}


def find_errors(reference: ComparedSamples, run: ComparedSamples) -> Errors:
    """Compare a run with the reference, sample by sample where the levels of both agree.

    Returns
    -------
    dict
        By kind (see ``KINDS``) a dict of its ``value``, the worst element ``item`` and more of it, None if the
        scene has nothing of the kind or it is constant; ``apart``, the share of samples left out.
    """
    together = (reference.levels == run.levels).all(axis=1)
    found: Errors = dict.fromkeys(KINDS) | {"apart": float(1 - together.mean())}
    if together.sum() < 2:
        return found
    for kind, floor in _floors(reference).items():
        found[kind] = _worst_signal(reference.signals[kind], run.signals[kind], together, floor)
    one, two = ({name: force.real for name, force in s.signals["mesh_force"].items()} for s in (reference, run))
    found["load_share"] = _load_share(
        reference.groups, *({name: force[together] for name, force in s.items()} for s in (one, two))
    )  # fmt: skip
    found["spectrum"] = _spectrum(one, two, together, reference.phases)
    found["states"] = _states(reference.states, run.states, together)
    return found


def value_of(errors: Errors, kind: str) -> float | None:
    """Return the worst error of a kind; None if there is none."""
    entry = errors.get(kind)
    return None if entry is None else float(entry["value"])


def _floors(reference: ComparedSamples) -> dict[str, float]:
    """Return by kind the vibration below which a signal is constant: forces that cancel leave rounding only."""
    sizes = {
        kind: max((float(np.abs(signal).max()) for signal in signals.values()), default=0.0)
        for kind, signals in reference.signals.items()
    }
    sizes["bearing_force"] = max(sizes["bearing_force"], sizes["mesh_force"])
    return {kind: STILL * size for kind, size in sizes.items()}


def _worst_signal(
    one: Mapping[str, Signal], two: Mapping[str, Signal], together: NDArray[np.bool_], floor: float
) -> Errors | None:
    """Return the errors of the signal that is off most, by the root mean square over its vibration."""
    found: list[Errors] = []
    for name, signal in one.items():
        errors = compare_signals(two[name][together], signal[together])
        value = errors["rms_over_vibration"]
        if value is not None and signal[together].std() > floor:
            found.append({"value": value, "item": name, **errors})
    return max(found, key=lambda errors: float(errors["value"]), default=None)


def _load_share(groups: list[list[str]], one: Forces, two: Forces) -> Errors | None:
    """Return the largest difference of a planet's share: its mean force over the mean of all planets."""
    found: list[Errors] = []
    for meshes, (before, after) in share_loads(one, two, groups).items():
        off = np.abs(after - before)
        found.append({"value": float(off.max()), "item": meshes[int(off.argmax())]})
    return max(found, key=lambda errors: float(errors["value"]), default=None)


def _spectrum(
    one: Mapping[str, Vector], two: Mapping[str, Vector], together: NDArray[np.bool_], phases: Mapping[str, Vector]
) -> Errors | None:
    """Return the largest difference in dB of a line at a mesh order; weak lines are left out."""
    found: list[Errors] = []
    for mesh, phase in phases.items():
        if mesh not in one:
            continue
        before, after = pair_orders(one[mesh], np.where(together, two[mesh], one[mesh]), phase)
        lines = np.flatnonzero(before > LINES * before.max(initial=0.0))
        if len(lines):
            decibels = 20 * np.abs(np.log10(np.maximum(after[lines], 1e-300) / before[lines]))
            worst = int(decibels.argmax())
            found.append({"value": float(decibels[worst]), "item": mesh, "order": int(lines[worst]) + 1})
    return max(found, key=lambda errors: float(errors["value"]), default=None)


def _states(one: Mapping[str, Vector], two: Mapping[str, Vector], together: NDArray[np.bool_]) -> Errors | None:
    """Return the error of the state that is off most."""
    off = {name: float(np.sqrt(np.mean((two[name] - x)[together] ** 2))) for name, x in one.items()}
    worst = max(off, key=off.__getitem__, default=None)
    return None if worst is None else {"value": off[worst], "item": worst}
