"""The gear pair with clearance, swept up and down: its jumps by every method, and how slow a sweep must be.

Run as ``python -m benchmarks.dead_band``; it writes the tables of docs/dead-band.md and its figure.
"""

from itertools import chain
from pathlib import Path

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
from ltcgear.runtime.model.building import build
from ltcgear.runtime.results.table import Table
from ltcgear.runtime.simulation.methods.registry import METHODS
from ltcgear.runtime.studies.selftest.case import Bench
from ltcgear.runtime.studies.selftest.dead_band import (
    AMPLITUDES,
    FINE,
    JUMPS,
    LONG_SWEEP,
    SHORT_SWEEP,
    STEPS,
    DeadBand,
    MeshCycles,
    small_amplitude,
    staircase,
)
from ltcgear.runtime.view.plots import BLUE, GREY, ORANGE
from ltcgear.symbolic.assembly import build_model
from ltcgear.symbolic.emit.pipeline import obtain
from ltcgear.symbolic.scene.load import load_scene

PAGE = Path(__file__).resolve().parents[1] / "docs" / "dead-band.md"
FIGURE = PAGE.parent / "dead-band.svg"
BEGIN, END = "<!-- {} -->\n", "<!-- end of {} -->\n"
RATES = (3e-4, 1e-4, 3e-5, 1e-5)
"""Change of the frequency, over the natural one, in a unit of time."""
NEAR = ((0.8, 0.86), (0.74, 0.66))
"""Where slow sweeps begin and end, up and down; quick ones lead from 0.75 to the first, and on to the second."""


def scene() -> DeadBand:
    """Build the shipped scene."""
    model = build_model(load_scene("hard-dead-band"))
    return DeadBand(Bench(build(obtain(model)), model.values(), model.tables))


def jumps(pair: DeadBand, method: str) -> tuple[float, float]:
    """Return the frequencies of the jumps of the hard case's sweep."""
    times, frequencies, end = SHORT_SWEEP
    swept = pair.swept(times, frequencies)
    return swept.cycles(swept.run(method, end)).jumps((times[1] + times[2]) / 2)


def slow_jumps(pair: DeadBand, rate: float) -> tuple[float, float]:
    """Return the frequencies of the jumps of a sweep at one rate."""
    (low, high), (top, bottom) = NEAR
    durations = (200.0, 600.0, (high - low) / rate, 300.0, 1200.0, (top - bottom) / rate)
    times = tuple(np.cumsum(durations))
    swept = pair.swept(times, (0.75, low, high, high, top, bottom))
    return swept.cycles(swept.run("erk", times[-1])).jumps(times[3])


def table_of_methods(pair: DeadBand) -> str:
    """Return the table of jumps by method."""
    found = {method: jumps(pair, method) for method in METHODS} | {"reference, SciPy's DOP853 with events": JUMPS}
    rows = tuple((name, f"{up:.4f}", f"{down:.4f}") for name, (up, down) in found.items())
    return Table("", ("engine", "jump up", "jump down"), rows).to_markdown()


def table_of_rates(pair: DeadBand) -> str:
    """Return the table of jumps by rate; both go with the rate to the power of 2/3, so that no rate has a limit."""
    found = {rate: slow_jumps(pair, rate) for rate in RATES}
    slowest = np.array([found[rate] for rate in RATES[-2:]])
    scale = np.array(RATES[-2:]) ** (2 / 3)
    limit = slowest[1] - scale[1] * (slowest[0] - slowest[1]) / (scale[0] - scale[1])
    rows = []
    for rate, pairs in found.items():
        cells = ((f"{jump:.4f}", f"{100 * (jump / end - 1):+.1f} %") for jump, end in zip(pairs, limit, strict=True))
        rows.append((f"{rate:.0e}", *chain.from_iterable(cells)))
    rows.append(("none (extrapolated)", f"{limit[0]:.3f}", "", f"{limit[1]:.3f}", ""))
    columns = "change of frequency in a unit of time", "jump up", "off", "jump down", "off"
    return Table("", columns, tuple(rows)).to_markdown()


def draw(pair: DeadBand) -> None:
    """Draw the sweep over the whole range, the steady amplitudes and the linear response."""
    times, frequencies, end = LONG_SWEEP
    swept = pair.swept(times, frequencies)
    cycles: MeshCycles = swept.cycles(swept.run("erk", end))
    figure, axis = plt.subplots(figsize=(8, 4.2), layout="constrained")
    turn = (times[1] + times[2]) / 2
    for chosen, colour, label in (
        ((cycles.time > times[0]) & (cycles.time < turn), BLUE, "sweep up"),
        (cycles.time > turn, ORANGE, "sweep down"),
    ):
        axis.plot(cycles.frequency[chosen], cycles.amplitude[chosen], color=colour, label=label)
    line = np.linspace(0.4, 1.4, 400)
    linear = [small_amplitude(pair, value) for value in line]
    axis.plot(line, linear, color=GREY, ls="--", lw=1, label="linear, teeth together")
    axis.axhline(pair.force, color=GREY, ls=":", lw=1, label="teeth part above")
    knots, given = staircase(STEPS)
    steps = pair.swept(knots, given)
    steady = steps.cycles(steps.run("erk", knots[-1], FINE))
    heights = [steady.before(knots[2 * i + 1]) for i in range(len(STEPS))]
    axis.plot(STEPS, heights, "ko", mfc="none", label="dwelling")
    axis.plot(STEPS, AMPLITUDES, "k+", label="dwelling, reference")
    axis.set(xlabel="mesh frequency over natural frequency", ylabel="amplitude over half the gap", xlim=(0.4, 1.4))
    axis.set_ylim(0.0, 0.4)
    axis.legend(frameon=False)
    with mpl.rc_context({"svg.hashsalt": "dead-band", "svg.fonttype": "none"}):
        figure.savefig(FIGURE, metadata={"Date": None})


def main() -> None:
    """Simulate and write page and figure."""
    pair, text = scene(), PAGE.read_text("utf-8")
    for name, made in (("methods", table_of_methods(pair)), ("rates", table_of_rates(pair))):
        print(made)
        begin, end = BEGIN.format(name), END.format(name)
        before, rest = text.split(begin)
        text = before + begin + made + end + rest.split(end)[1]
    PAGE.write_text(text, "utf-8")
    draw(pair)


if __name__ == "__main__":
    main()
