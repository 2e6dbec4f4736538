"""Tables of Floquet multipliers and of the stability chart."""

from typing import TYPE_CHECKING, Any

import numpy as np

from ...linear.chart import RPM, Chart
from ...results.table import Table

if TYPE_CHECKING:
    from ...linear.floquet import Floquet, Multiplier
    from ...linear.tongues import Tongue

Data = dict[str, Any]
SHOWN = 12
"""Rows of a table; all are in the JSON object."""
LINEAR = "small motions about the mean loaded equilibrium, for a constant speed; teeth that touch stay in touch"


def describe_multipliers(scene: str, found: "Floquet", speed: float) -> Data:
    """Return multipliers as plain data.

    Parameters
    ----------
    scene
        Its name.
    found
        The multipliers.
    speed
        Speed of the reference [rad/s].
    """
    periodic, first = found.periodic, found.multipliers[0]
    return {
        "scene": scene, "meshes": periodic.meshes, "speed_rpm": speed / RPM,
        "mesh_frequencies_hz": periodic.mesh_frequencies, "period_s": periodic.period,
        "jumps": len(periodic.borders) - 1 if not periodic.follows else None, "error": found.error,
        "stable": found.stable, "largest": abs(first.value), "growth_rate": first.growth,
        "multipliers": [_multiplier(item) for item in found.multipliers],
    }  # fmt: skip


def _multiplier(item: "Multiplier") -> Data:
    resonance = item.resonance
    return {
        "real": item.value.real, "imag": item.value.imag, "modulus": abs(item.value), "growth_rate": item.growth,
        "frequency_hz": item.frequency_hz, "mode": item.mode,
        "resonance": None if resonance is None else {
            "name": resonance.name, "kind": resonance.kind, "modes": list(resonance.modes),
            "frequencies_hz": list(resonance.frequencies_hz), "order": resonance.order,
        },
    }  # fmt: skip


def describe_chart(scene: str, chart: Chart) -> Data:
    """Return a chart as plain data."""
    return {
        "scene": scene, "meshes": chart.meshes, "speeds_rpm": (chart.speeds / RPM).tolist(),
        "variations": chart.variations.tolist(), "base_frequencies_hz": chart.base_hz.tolist(),
        "largest": chart.largest.tolist(), "growth_rate": chart.growth.tolist(),
        "points": chart.largest.size, "unstable": int((~chart.stable).sum()),
        "tongues": [_tongue(item) for item in chart.tongues],
    }  # fmt: skip


def _tongue(item: "Tongue") -> Data:
    return {
        "name": item.resonance.name, "kind": item.resonance.kind, "modes": list(item.resonance.modes),
        "frequencies_hz": list(item.resonance.frequencies_hz), "order": item.resonance.order,
        "speed_rpm": abs(item.speed) / RPM, "base_frequency_hz": item.base / (2 * np.pi),
        "least_variation": item.least, "half_width_rpm": float(item.half_width(np.array(1.0)) / RPM),
    }  # fmt: skip


def tabulate_multipliers(data: Data) -> list[Table]:
    """Return tables of multipliers for people."""
    rows = tuple(
        (item["modulus"], item["growth_rate"], item["frequency_hz"], item["mode"],
         item["resonance"]["name"] if item["resonance"] else "")
        for item in data["multipliers"][:SHOWN]
    )  # fmt: skip
    rates = ", ".join(f"{stage} {hertz:.6g} Hz" for stage, hertz in data["mesh_frequencies_hz"].items())
    verdict = "stable: every small motion dies away or stays" if data["stable"] else "UNSTABLE: small motions grow"
    notes = [
        f"{verdict}; largest |mu| {data['largest']:.9g}, growth {data['growth_rate']:.4g} 1/s",
        f"period {data['period_s']:.6g} s; mesh frequencies {rates}; {LINEAR}",
    ]
    if len(data["multipliers"]) > SHOWN:
        notes.append(f"{len(data['multipliers']) - SHOWN} smaller ones are not shown; --json or -o FILE.csv has all")
    if any(row[-1] for row in rows):
        notes.append("w1 is mode 1 of `ltcgear modes`, W the mesh frequency, or one over the common period of stages")
    title = f"Floquet multipliers of {data['scene']} at {data['speed_rpm']:.6g} rpm"
    columns = ("|mu|", "growth [1/s]", "frequency [Hz]", "mode", "what combines")
    return [Table(title, columns, rows, tuple(notes))]


def tabulate_chart(data: Data) -> list[Table]:
    """Return tables of a chart for people."""
    rows = tuple(
        (item["name"], ", ".join(f"{hertz:.5g}" for hertz in item["frequencies_hz"]), item["base_frequency_hz"],
         item["speed_rpm"], item["least_variation"], item["half_width_rpm"])
        for item in data["tongues"][:SHOWN]
    )  # fmt: skip
    speeds, variations = data["speeds_rpm"], data["variations"]
    worst = max(max(row) for row in data["largest"])
    notes = [
        f"{data['unstable']} of {data['points']} points unstable: {len(speeds)} speeds from {speeds[0]:.5g} to "
        f"{speeds[-1]:.5g} rpm, {len(variations)} variations from {variations[0]:.4g} to {variations[-1]:.4g}; "
        f"largest |mu| {worst:.6g}",
        "first-order theory: where a tongue's middle lies, from which variation on it grows, and over which speeds "
        "to either side at variation 1 (a dash: it does not)",
        LINEAR,
    ]
    if len(data["tongues"]) > SHOWN:
        notes.append(f"{len(data['tongues']) - SHOWN} narrower tongues are not shown; --json has all")
    columns = ("tongue", "modes [Hz]", "W [Hz]", "speed [rpm]", "from variation", "half width [rpm]")
    return [Table(f"Tongues of {data['scene']}", columns, rows, tuple(notes))]
