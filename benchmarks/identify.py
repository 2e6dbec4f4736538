"""What the paper does not print, identified: fits the rig to Table 9, writes the scene rig-2mw-fitted and the record.

Run as ``OPENBLAS_NUM_THREADS=1 python -m benchmarks.identify``; it takes a quarter of an hour. All combinations of the
readings that the print leaves open are screened by short runs; from the best points of the best ones, Gauss-Newton
searches follow with the model's own sensitivities. The result with the smallest sum is kept.
"""

import json
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from ltcgear.runtime.identification.fit import Fit, fit
from ltcgear.runtime.identification.forecast import Span
from ltcgear.runtime.identification.rig import combinations, rig_choices, rig_targets, rig_unknowns
from ltcgear.runtime.identification.screening import screen, spread_points
from ltcgear.runtime.identification.unknowns import Unknown, changes_of
from ltcgear.runtime.library import Library, build
from ltcgear.runtime.simulation import simulate
from ltcgear.runtime.statistics import group_of
from ltcgear.symbolic.build import build_model
from ltcgear.symbolic.pipeline import obtain
from ltcgear.symbolic.scene import SHIPPED, load_scene

ROOT = Path(__file__).resolve().parents[1]
RECORD = ROOT / "runtime" / "published" / "fitted.json"
SCENE, FITTED = "rig-2mw", "rig-2mw-fitted"
SPAN = Span(1.0, 0.5)
"""A turn of the HSP carrier and more; what the start leaves behind has mostly died away after half of it."""
POINTS, SEED = 32, 7
CLOSER, CLOSE_POINTS, SEARCHES = 2, 128, 3
"""Readings that are looked at more closely, points for each, and searches from the best of these."""
LONG, RATE, DIGITS = 4.0, 8192.0, 4
Vector = np.ndarray


class Rig:
    """The rig with one reading of the print: one model, whose numbers follow the unknowns."""

    def __init__(self, reading: dict[str, str], unknowns: list[Unknown]) -> None:
        self.reading, self.unknowns = reading, unknowns
        self.library: Library = build(obtain(build_model(load_scene(SCENE, reading))))
        self.named = {target.output.partition(":")[2]: target for target in rig_targets()}

    def numbers(self, z: Vector) -> dict[str, float]:
        """Return the model's parameters at a point."""
        return build_model(load_scene(SCENE, self.reading | changes_of(self.unknowns, z))).values()

    def parameters(self, z: Vector) -> Vector:
        """Return them as the C takes them."""
        return self.library.parameters(self.numbers(z))

    def forces(self, z: Vector, t_end: float, rtol: float) -> dict[str, dict[str, float]]:
        """Return means of the statistics over each group of meshes, second half of a run."""
        result = simulate(self.library, self.numbers(z), t_end=t_end, rate=RATE, method="erk", rtol=rtol)
        groups: dict[str, list[dict[str, float]]] = {}
        for mesh, found in result.summary["forces"].items():
            groups.setdefault(group_of(mesh), []).append(found)
        return {
            group: {key: float(np.mean([item[key] for item in items])) for key in ("mean", "amplitude", "load_factor")}
            for group, items in groups.items()
        }

    def residuals(self, z: Vector) -> Vector:
        """Return the targets' residuals of a short run, by its statistics."""
        forces = self.forces(z, SPAN.t_end, 1e-4)
        return np.array(
            [
                (forces[group_of(mesh)]["load_factor"] - target.value) / target.sigma
                for mesh, target in self.named.items()
            ]
        )


def search(unknowns: list[Unknown], told: Callable[[str], None] = print) -> tuple[Rig, list[tuple[Rig, Fit]], Any]:
    """Screen all readings and fit the best; return the best rig, all fits (the best first), and the screening."""
    points = spread_points(unknowns, POINTS, SEED)
    found = []
    for reading in combinations():
        rig = Rig(reading, unknowns)
        found.append((screen(rig.residuals, points)[0][0], rig))
        told(f"screened {' '.join(reading.values())}: {found[-1][0]:.1f}")
    found.sort(key=lambda item: item[0])
    fits = []
    for _, rig in found[:CLOSER]:
        for _, z in screen(rig.residuals, spread_points(unknowns, CLOSE_POINTS, SEED))[:SEARCHES]:
            made = fit(rig.library, rig.parameters, unknowns, rig_targets(), SPAN, z, most=12)
            fits.append((rig, made))
            told(f"{' '.join(rig.reading.values())}: {made.misfit:.2f} + {made.strayed:.2f} {made.forecast.round(3)}")
    fits.sort(key=lambda item: item[1].misfit + item[1].strayed)
    return fits[0][0], fits, found


def rounded(unknown: Unknown, z: float) -> float:
    """Return a fitted value with as many digits as are written."""
    return float(f"{unknown.value(z):.{DIGITS}g}")


def tell_unknowns(unknowns: list[Unknown], made: Fit) -> list[dict[str, Any]]:
    """List what was found of each unknown: value, and the range of one standard deviation that is left."""
    return [
        {
            "name": unknown.name, "keys": list(unknown.keys), "unit": unknown.unit, "assumed": unknown.start,
            "low": unknown.low, "high": unknown.high, "source": unknown.source, "fitted": rounded(unknown, z),
            "from": float(max(unknown.value(z - left), unknown.low)),
            "to": float(min(unknown.value(z + left), unknown.high)), "left": float(left),
            "strength": [float(value) for value in made.jacobian[:, k]],
        }
        for k, (unknown, z, left) in enumerate(zip(unknowns, made.z, made.narrowing, strict=True))
    ]  # fmt: skip


def record(rig: Rig, fits: list[tuple[Rig, Fit]], screened: Any) -> dict[str, Any]:  # noqa: ANN401
    """Put the outcome into plain values."""
    unknowns, made = rig.unknowns, fits[0][1]
    told = tell_unknowns(unknowns, made)
    place = np.array([unknown.place(item["fitted"]) for unknown, item in zip(unknowns, told, strict=True)])
    assumed = Rig(combinations()[0], unknowns)
    covariance = made.covariance / np.outer(made.narrowing, made.narrowing)
    pairs = sorted(
        ((float(covariance[i, k]), i, k) for i in range(len(told)) for k in range(i)), key=lambda item: -abs(item[0])
    )
    return {
        "scene": SCENE, "made_by": "python -m benchmarks.identify",
        "span": vars(SPAN), "long": LONG,
        "readings": [
            {"name": choice.name, "key": choice.key, "assumed": choice.values[0], "chosen": rig.reading[choice.key],
             "values": list(choice.values)}
            for choice in rig_choices()
        ],
        "unknowns": told,
        "targets": [
            {"name": target.name, "output": target.output, "printed": target.value, "sigma": target.sigma,
             "forecast": float(value)}
            for target, value in zip(rig_targets(), made.forecast, strict=True)
        ],
        "misfit": made.misfit, "strayed": made.strayed, "determined": made.determined, "runs": made.runs,
        "correlations": [
            {"one": told[k]["name"], "other": told[i]["name"], "correlation": value} for value, i, k in pairs[:6]
        ],
        "screened": [
            {"reading": list(item.reading.values()), "sum": float(total)} for total, item in screened
        ],
        "fits": [
            {"reading": list(item.reading.values()), "misfit": one.misfit, "strayed": one.strayed,
             "forecast": [float(value) for value in one.forecast]}
            for item, one in fits
        ],
        "forces": {
            "assumed": assumed.forces(np.zeros(len(unknowns)), LONG, 1e-6), "fitted": rig.forces(place, LONG, 1e-6),
        },
    }  # fmt: skip


def write_scene(text: str, data: dict[str, Any]) -> str:
    """Put the fitted numbers and readings into the text of the scene, each labelled as such."""
    new: dict[str, tuple[str, str]] = {}
    for item in data["unknowns"]:
        value = f"{item['fitted']:g} {item['unit']}" if item["unit"] else f"{item['fitted']:g}"
        written = f'"{value}"' if item["unit"] else value
        why = f"fitted: {item['name']}, against Table 9 within {item['low']:g} to {item['high']:g}; docs/rig.md"
        new |= dict.fromkeys(item["keys"], (written, why))
    for item in data["readings"]:
        if item["chosen"] != item["assumed"]:
            new[item["key"]] = (f'"{item["chosen"]}"', f"fitted: {item['name']}, the reading nearest to Table 9")
    lines, section, last = [], "", {}
    for line in text.splitlines():
        if match := re.match(r"\[([\w.]+)\]", line):
            section = match[1]
        elif match := re.match(r"([\w.]+) = ", line):
            key = f"{section}.{match[1]}" if section else match[1]
            if key in new:
                value, why = new.pop(key)
                line = f'{match[1]} = {{ value = {value}, source = "{why}" }}'
            elif key == "title":
                line = line.rstrip('"') + ', unprinted numbers fitted"'
            last[section] = len(lines)
        lines.append(line)
    for key, (value, why) in new.items():
        section, _, name = key.rpartition(".")
        lines[last[section]] += f'\n{name} = {{ value = {value}, source = "{why}" }}'
    head = "# Written by `python -m benchmarks.identify` from rig-2mw: numbers labelled fitted are that fit's.\n"
    return head + "\n".join(lines) + "\n"


def main() -> None:
    """Fit, and write record and scene."""
    rig, fits, screened = search(rig_unknowns())
    data = record(rig, fits, screened)
    RECORD.write_text(json.dumps(data, indent=1) + "\n", "utf-8")
    scenes = Path(str(SHIPPED))
    (scenes / f"{FITTED}.toml").write_text(write_scene((scenes / f"{SCENE}.toml").read_text("utf-8"), data), "utf-8")
    for item in data["unknowns"]:
        print(f"{item['name']}: {item['assumed']:g} -> {item['fitted']:g} {item['unit']} ({item['left']:.2f})")
    print(json.dumps(data["forces"], indent=1))


if __name__ == "__main__":
    main()
