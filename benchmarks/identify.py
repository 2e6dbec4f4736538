"""What the paper does not print, identified: fits the rig to Table 9, writes the scene rig-2mw-fitted and the record.

Run as ``OPENBLAS_NUM_THREADS=1 python -m benchmarks.identify``; it takes half an hour. All combinations of the
readings that the print leaves open are screened by short runs; from the best points of the best ones, Gauss-Newton
searches follow with the model's own sensitivities. The result with the smallest sum is kept, rounded as it is written,
polished over secants, and what is left open is told there. ``--polish`` does the last part anew from the kept record,
``--tables`` writes scene and tables from it.
"""

import json
import re
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from ltcgear.runtime.linear.modes import Mode, find_modes
from ltcgear.runtime.linear.naming import describe_modes
from ltcgear.runtime.linear.sensitivity import differentiate_modes
from ltcgear.runtime.linear.system import Linear, linearise
from ltcgear.runtime.model.building import build
from ltcgear.runtime.model.equilibrium import find_equilibrium
from ltcgear.runtime.model.library import Library
from ltcgear.runtime.model.members import train_of
from ltcgear.runtime.model.operating_point import OperatingPoint
from ltcgear.runtime.results.table import Table
from ltcgear.runtime.simulation.simulate import simulate
from ltcgear.runtime.studies.wu2021.table9 import tell_loads
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.emit.pipeline import obtain
from ltcgear.symbolic.scene.load import SHIPPED, load_scene

from benchmarks.identification.fitting import Fit, fit, parameter_slopes, spread_of
from benchmarks.identification.forecast import Forecast, Span
from benchmarks.identification.posterior import SECANT, Posterior, look_around, move_alone, polish, total
from benchmarks.identification.rig import combinations, rig_choices, rig_targets, rig_unknowns
from benchmarks.identification.screening import screen, spread_points
from benchmarks.identification.unknowns import Unknown, bounds_of, changes_of

from .marks import put

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "rig.md"
RECORD = ROOT / "runtime" / "studies" / "wu2021" / "published" / "fitted.json"
SCENE, FITTED = "rig-2mw", "rig-2mw-fitted"
SPAN = Span(1.0, 0.5)
"""A turn of the HSP carrier and more; what the start leaves behind has mostly died away after half of it."""
POINTS, SEED = 32, 7
CLOSER, CLOSE_POINTS, SEARCHES, TRIALS = 5, 128, 3, 12
"""Readings that are looked at more closely, points for each, searches from the best of these, and trials of each."""
LONG, RATE, DIGITS, MODES = 4.0, 8192.0, 4, 7
Vector = np.ndarray


class Rig:
    """The rig with one reading of the print: one model, whose numbers follow the unknowns."""

    def __init__(self, reading: dict[str, str], unknowns: list[Unknown]) -> None:
        self.reading, self.unknowns = reading, unknowns
        self.library: Library = build(obtain(build_model(load_scene(SCENE, reading))))
        self.train = train_of(self.library.manifest)
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
            groups.setdefault(self.train.group(mesh), []).append(found)
        return {
            group: {key: float(np.mean([item[key] for item in items])) for key in ("mean", "amplitude", "load_factor")}
            for group, items in groups.items()
        }

    def forecast(self, z: Vector) -> Vector:
        """Return what a run says of the targets, as the search has it."""
        return Forecast(self.library, self.parameters(z), rig_targets(), SPAN).values()

    def misfits(self, z: Vector) -> Vector:
        """Return the targets' residuals of that run."""
        return np.array(
            [(y - target.value) / target.sigma for y, target in zip(self.forecast(z), rig_targets(), strict=True)]
        )

    def residuals(self, z: Vector) -> Vector:
        """Return the targets' residuals of a short run, by its statistics."""
        forces = self.forces(z, SPAN.t_end, 1e-4)
        return np.array(
            [
                (forces[self.train.group(mesh)]["load_factor"] - target.value) / target.sigma
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
    fits: list[tuple[Rig, Fit]] = []

    def follow(rig: Rig, z: Vector) -> None:
        made = fit(rig.library, rig.parameters, unknowns, rig_targets(), SPAN, z, most=TRIALS)
        fits.append((rig, made))
        told(f"{' '.join(rig.reading.values())}: {made.misfit:.2f} + {made.strayed:.2f} {made.forecast.round(3)}")
        for warning in made.warnings:
            told(f"warning: {warning}")

    for _, rig in found[:CLOSER]:
        for _, z in screen(rig.residuals, spread_points(unknowns, CLOSE_POINTS, SEED))[:SEARCHES]:
            follow(rig, z)
    fits.sort(key=sum_of)
    return fits[0][0], fits, found


def sum_of(item: tuple[Rig, Fit]) -> float:
    """Return the sum that a fit makes small."""
    return item[1].misfit + item[1].strayed


def rounded(unknown: Unknown, z: float) -> float:
    """Return a fitted value with as many digits as are written."""
    return float(f"{unknown.value(z):.{DIGITS}g}")


def written(unknowns: list[Unknown], z: Vector) -> Vector:
    """Return the point whose numbers are those written."""
    return np.array([unknown.place(rounded(unknown, place)) for unknown, place in zip(unknowns, z, strict=True)])


def kept_place(data: dict[str, Any]) -> tuple[Rig, Vector]:
    """Return the rig of a record and the point it holds."""
    unknowns = rig_unknowns()
    rig = Rig({item["key"]: item["chosen"] for item in data["readings"]}, unknowns)
    return rig, np.array([one.place(item["fitted"]) for one, item in zip(unknowns, data["unknowns"], strict=True)])


def record(rig: Rig, fits: list[tuple[Rig, Fit]], screened: Any) -> dict[str, Any]:  # noqa: ANN401
    """Put the outcome of a search into plain values."""
    return {
        "scene": SCENE, "made_by": "python -m benchmarks.identify",
        "span": vars(SPAN),
        "readings": [
            {"name": choice.name, "key": choice.key, "assumed": choice.values[0], "chosen": rig.reading[choice.key],
             "values": list(choice.values)}
            for choice in rig_choices()
        ],
        "unknowns": [
            {"name": unknown.name, "keys": list(unknown.keys), "unit": unknown.unit, "assumed": unknown.start,
             "low": unknown.low, "high": unknown.high, "source": unknown.source, "fitted": rounded(unknown, z)}
            for unknown, z in zip(rig.unknowns, fits[0][1].z, strict=True)
        ],
        "screened": [
            {"reading": list(item.reading.values()), "sum": float(total)} for total, item in screened
        ],
        "fits": [
            {"reading": list(item.reading.values()), "misfit": one.misfit, "strayed": one.strayed,
             "forecast": [float(value) for value in one.forecast], "ended": one.message}
            for item, one in fits
        ],
    }  # fmt: skip


def refine(data: dict[str, Any], told: Callable[[str], None] = print) -> None:
    """Polish the point of a record and tell there what is left open; both at the numbers that are written."""
    rig, z = kept_place(data)
    low, high = bounds_of(rig.unknowns)
    best = total(rig.misfits, z)
    made = fit(rig.library, rig.parameters, rig.unknowns, rig_targets(), SPAN, z, most=TRIALS)
    if total(rig.misfits, written(rig.unknowns, made.z)) < best:  # steps that had become short grow again
        z = written(rig.unknowns, made.z)
    told(f"{best:.3f}, searched to {total(rig.misfits, z):.3f}: {made.message}")
    z = polish(rig.misfits, z, low, high, lambda at: written(rig.unknowns, at), told=lambda s: told(f"{s:.3f}"))
    here = look_around(rig.misfits, z, low, high)
    data["posterior"] = {
        "search": made.message, "secant": SECANT, "gradient": float(np.linalg.norm(here.gradient)),
        "misfit": float(here.residuals @ here.residuals), "strayed": float(z @ z), "determined": here.determined,
    }  # fmt: skip
    data["targets"] = [
        {"name": target.name, "output": target.output, "printed": target.value, "sigma": target.sigma,
         "forecast": float(target.value + residual * target.sigma)}
        for target, residual in zip(rig_targets(), here.residuals, strict=True)
    ]  # fmt: skip
    for k, (unknown, item) in enumerate(zip(rig.unknowns, data["unknowns"], strict=True)):
        item |= {"fitted": rounded(unknown, z[k])} | tell_range(rig, here, k, low, high)
        told(f"{item['name']}: {item['from']:.4g} {item['to']:.4g}, {item['rises']}, {item['alone']}")
    data["correlations"] = tell_correlations(here, data["unknowns"])


def tell_range(rig: Rig, here: Posterior, k: int, low: Vector, high: Vector) -> dict[str, Any]:
    """Tell how well a number is known: linearised, with the sum's rise at the ends of that range, and moved alone."""
    unknown, left, z = rig.unknowns[k], here.narrowing[k], here.z[k]
    ends = np.clip([z - left, z + left], low[k], high[k])
    base = total(rig.misfits, here.z)
    rises = [total(rig.misfits, np.clip(here.follow(k, (end - z) / left), low, high)) - base for end in ends]
    return {
        "from": unknown.value(ends[0]), "to": unknown.value(ends[1]), "left": float(left), "rises": rises,
        "alone": [unknown.value(place) for place in move_alone(rig.misfits, here.z, k, low, high)],
        "strength": [float(value) for value in here.jacobian[:, k]],
    }  # fmt: skip


def tell_correlations(here: Posterior, told: list[dict[str, Any]]) -> list[dict[str, Any]]:
    """List the strongest correlations of what is left open."""
    covariance = here.covariance / np.outer(here.narrowing, here.narrowing)
    pairs = sorted(
        ((float(covariance[i, k]), i, k) for i in range(len(told)) for k in range(i)), key=lambda item: -abs(item[0])
    )
    return [{"one": told[k]["name"], "other": told[i]["name"], "correlation": value} for value, i, k in pairs[:6]]


def write_scene(text: str, data: dict[str, Any]) -> str:
    """Put the fitted numbers and readings into the text of the scene, each labelled as such."""
    new: dict[str, tuple[str, str]] = {}
    for item in data["unknowns"]:
        value = f"{item['fitted']:g} {item['unit']}" if item["unit"] else f"{item['fitted']:g}"
        written = f'"{value}"' if item["unit"] else value
        why = (
            f"fitted: {item['name']}, {item['from']:.3g} to {item['to']:.3g} (one sigma, linearised), alone "
            f"{item['alone'][0]:.4g} to {item['alone'][1]:.4g}, against Table 9 within {item['low']:g} to "
            f"{item['high']:g}; {item['assumed']:g} was assumed"
        )
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


def load_table(data: dict[str, Any]) -> str:
    """Return the mesh forces of both rigs beside Table 9, in Markdown."""
    columns = "mesh", "printed", "assumed", "fitted", "factor printed", "assumed", "fitted"
    rows = []
    for row in data["table9"]:
        forces = (f"{one['mean']:.2f} +- {one['amplitude']:.2f}" for one in row["rigs"].values())
        factors = (f"{one['factor']:.3f} ({one['factor_off']:+.1%})" for one in row["rigs"].values())
        printed = f"{row['mean']:.2f} +- {row['amplitude']:.2f} ({row['component']})"
        rows.append((row["position"], printed, *forces, f"{row['factor']:.3f}", *factors))
    return Table("", columns, tuple(rows)).to_markdown()


def fit_table(data: dict[str, Any]) -> str:
    """Return what was fitted, in Markdown."""
    rows = []
    for item in data["unknowns"]:
        sigma, bounds = (f"{item[a]:.4g} to {item[b]:.4g}" for a, b in (("from", "to"), ("low", "high")))
        values = (f"{item[key]:.4g} {item['unit']}".strip() for key in ("assumed", "fitted"))
        risen, alone = (f"{format(one[0], form)} {word} {format(one[1], form)}" for one, form, word in (
            (item["rises"], ".1f", "and"), (item["alone"], ".4g", "to")
        ))  # fmt: skip
        rows.append((item["name"], *values, sigma, risen, alone, bounds, f"{item['left']:.2f}"))
    columns = (
        "number", "assumed", "fitted", "one sigma, linearised", "the sum rises there by", "alone", "bounds", "left",
    )  # fmt: skip
    changed = [f"{item['name']}: {item['chosen']}" for item in data["readings"] if item["chosen"] != item["assumed"]]
    known, best = data["posterior"], data["fits"][0]
    told = f"Determined by the targets, linearised: {known['determined']:.1f} of {len(data['unknowns'])}."
    others = [sum_kept(item) for item in data["fits"] if item["reading"] != best["reading"]]
    sums = (
        f"Sum of squares {sum_kept(known):.1f}, {sum_kept(best):.1f} before it was polished; {min(others):.1f} with "
        f"the next best readings, not polished. Half of the sum's slope over the secants: {known['gradient']:.1f}."
    )
    table = Table("", columns, tuple(rows)).to_markdown()
    return f"{table}\n{told} Readings changed: {'; '.join(changed) or 'none'}. {sums}\n"


def sum_kept(item: dict[str, Any]) -> float:
    """Return the sum that a record tells of a fit."""
    return float(item["misfit"] + item["strayed"])


def mode_table(data: dict[str, Any]) -> str:
    """Return what the fit says of the lowest modes, in Markdown."""
    rows = []
    for item in data["modes"]:
        alone = f"{item['alone'][0]:.2f} to {item['alone'][1]:.2f}"
        sigmas = f"{item['before']:.2f}", f"{item['after']:.2f}", alone
        rows.append((item["mode"], f"{item['hz']:.2f}", *sigmas, item["name"]))
    columns = "mode", "Hz", "sigma before", "sigma after, linearised", "numbers moved alone", "what it is"
    return Table("", columns, tuple(rows)).to_markdown()


def tell_modes(data: dict[str, Any]) -> list[dict[str, Any]]:
    """List the lowest eigenfrequencies with their standard deviations before the fit and after it [Hz]."""
    rig, z = kept_place(data)
    jacobian = np.array([item["strength"] for item in data["unknowns"]]).T
    linear, modes = find_named(rig, z)
    slopes = parameter_slopes(rig.parameters, z)
    moving = slopes.any(axis=1)
    swept = np.array(
        [[mode.frequency_hz for mode in find_named(rig, there)[1][:MODES]] for there in lone_ends(rig, z, data)]
    )
    found = []
    for item in differentiate_modes(linear, modes, list(range(1, MODES + 1))):
        before, after = spread_of(item.frequency_hz[moving] @ slopes[moving], jacobian)
        mode, own = modes[item.number - 1], swept[:, item.number - 1]
        found.append(
            {"mode": item.number, "hz": mode.frequency_hz, "name": mode.name, "before": before, "after": after,
             "alone": [float(own.min()), float(own.max())]}
        )  # fmt: skip
    return found


def find_named(rig: Rig, z: Vector) -> tuple[Linear, list[Mode]]:
    """Return the linear system at a point and its named modes."""
    p = rig.parameters(z)
    linear = linearise(OperatingPoint(rig.library, p, find_equilibrium(rig.library, p)))
    return linear, describe_modes(linear, find_modes(linear))


def lone_ends(rig: Rig, z: Vector, data: dict[str, Any]) -> list[Vector]:
    """Return the point, and those where one number has moved alone to an end of its range."""
    found = [z]
    for k, (unknown, item) in enumerate(zip(rig.unknowns, data["unknowns"], strict=True)):
        for value in item["alone"]:
            there = z.copy()
            there[k] = unknown.place(value)
            found.append(there)
    return found


def finish(data: dict[str, Any]) -> None:
    """Write what follows from a record: the scene, its long run beside the assumed rig's, record and page."""
    scenes = Path(str(SHIPPED))
    (scenes / f"{FITTED}.toml").write_text(write_scene((scenes / f"{SCENE}.toml").read_text("utf-8"), data), "utf-8")
    datasets = {}
    for rig, name in (("assumed", SCENE), ("fitted", FITTED)):
        model = build_model(load_scene(name))
        library = build(obtain(model))
        datasets[rig] = simulate(library, model.values(), t_end=LONG, rate=RATE, method="erk", rtol=1e-6).dataset
    data["modes"] = tell_modes(data)
    data["table9"] = tell_loads(datasets, LONG / 2)
    RECORD.write_text(json.dumps(data, indent=1) + "\n", "utf-8")
    put(PAGE, {"loads": load_table(data), "fit": fit_table(data), "modes": mode_table(data)})


def main() -> None:
    """Fit and write; with ``--polish`` or ``--tables``, only what follows from the kept record."""
    kept = {"--tables", "--polish"} & set(sys.argv)
    data = json.loads(RECORD.read_text("utf-8")) if kept else record(*search(rig_unknowns()))
    if "--tables" not in sys.argv:
        refine(data)
    finish(data)
    print(load_table(data), fit_table(data), sep="\n")


if __name__ == "__main__":
    main()
