"""Heading of the report: what a run was, how it was computed and how accurate it is."""

from __future__ import annotations

import json
from math import isfinite
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping

    from ...results.result import Result

OFF = ("off", "none", "rigid")


def describe_run(result: Result) -> dict[str, Any]:
    """Return the head of the page: title, effects, figures of the run with what they mean, and warnings."""
    summary, attributes = result.summary, result.dataset.attrs
    status = str(summary.get("status", ""))
    name, length = str(attributes.get("scene", "")), float(summary.get("simulated_s", 0.0))
    lead = [f"Scene {name}" if name else "A model built in Python", f"{length:.6g} s simulated"]
    return {
        "title": str(attributes.get("title") or name or "Simulation"),
        "lead": ", ".join(lead),
        "stopped": "" if status in ("", "done") else status,
        "chips": list_effects(attributes),
        "facts": list(_facts(summary)),
        "warnings": list(summary.get("warnings", [])),
    }


def list_effects(attributes: Mapping[str, Any]) -> list[dict[str, Any]]:
    """Return the scene's effects, those that are on first."""
    try:
        effects = json.loads(attributes["scene_json"])["effects"]
    except (KeyError, ValueError, TypeError):
        return []
    chips = [
        {"name": key.replace("_", " "), "value": str(value), "off": value in OFF} for key, value in effects.items()
    ]
    return sorted(chips, key=lambda chip: bool(chip["off"]))


def _facts(summary: Mapping[str, Any]) -> list[dict[str, str]]:
    """Return how the run was computed."""
    counts = summary.get("counts", {})
    found = [
        ("Method", f"{summary.get('method', '?')}", f"rtol {summary.get('rtol', 0.0):g}, {summary.get('engine', '')}"),
        (
            "Steps",
            f"{counts.get('steps', 0):,}",
            f"{counts.get('rhs', 0):,} right-hand sides, {counts.get('rejected', 0):,} steps rejected",
        ),
        ("Stiffness switchings", f"{counts.get('events', 0):,}", _switchings(counts)),
        ("Accuracy of mesh forces", *_accuracy(summary.get("accuracy"))),
        ("Energy balance", *_balance(summary)),
        ("Pace", *_pace(summary)),
    ]
    return [{"name": name, "value": value, "note": note} for name, value, note in found]


def _switchings(counts: Mapping[str, Any]) -> str:
    """Compare the number of switchings with kinematics; report contact events."""
    events, expected = counts.get("events", 0), counts.get("expected_events", 0)
    told = "as kinematics calls for" if events == expected else f"kinematics calls for {expected:,}"
    regimes = counts.get("regimes", 0)
    return f"{told}; {regimes:,} contacts made or lost" if regimes else told


def _accuracy(accuracy: Mapping[str, Any] | None) -> tuple[str, str]:
    """Report the estimated error of the worst mesh, or how to get an estimate."""
    if accuracy is None:
        return "not estimated", "simulate with --verify to have it"
    if accuracy.get("reason") or accuracy.get("worst") is None:
        return "not estimated", str(accuracy.get("reason") or "no mesh forces")
    error = accuracy["meshes"][accuracy["worst"]]
    rms, peak = (error.get(f"{word}_over_mean") for word in ("rms", "peak"))
    return (
        "-" if rms is None else f"{rms:.1e} rms",
        f"of the mean force{'' if peak is None else f', {peak:.1e} peak'}; {accuracy['worst']}, the worst mesh",
    )


def _balance(summary: Mapping[str, Any]) -> tuple[str, str]:
    """Report the error of the energy balance."""
    residual = summary.get("energy_residual")
    if residual is None or not isfinite(residual):
        return "-", "not known"
    return f"{abs(residual):.1e}", "of the strain energy is missing at the end"


def _pace(summary: Mapping[str, Any]) -> tuple[str, str]:
    """Report the speed of the run."""
    factor = summary.get("real_time_factor")
    seconds = summary.get("seconds", {}).get("integrate")
    took = "" if seconds is None else f"{seconds:.3g} s of integration"
    if not factor or not isfinite(factor):
        return "-", took
    value = f"{factor:.3g}" if factor >= 1 else f"1/{1 / factor:.3g}"
    return value, f"{'times' if factor >= 1 else 'of'} real time, {took}"


def list_versions(attributes: Mapping[str, Any]) -> str:
    """Return the versions that made a result, in one line."""
    try:
        versions = json.loads(attributes.get("versions", "{}"))
    except ValueError:
        versions = {}
    told = ", ".join(f"{name} {version}" for name, version in versions.items())
    return f"Simulated by {told or 'an unknown version'}." + (
        f" Chosen method: {attributes['method']}, since {attributes['why']}." if attributes.get("why") else ""
    )
