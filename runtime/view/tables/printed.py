"""Terminal output of commands: one JSON object, or tables and lines of the same data."""

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from rich.padding import Padding

from ...results.attributes import finite
from ...results.table import Table
from ...results.terminal import Terminal, paragraph, plain, say
from .run_tables import list_costs, list_forces
from .scene_tables import form

Data = dict[str, Any]
STATISTICS = ("mean", "rms", "load_factor")
"""Statistics whose accuracy is told."""


def show(as_json: bool, data: Data, for_people: Callable[[Data], None]) -> None:
    """Print as JSON, or for people."""
    if as_json:
        print(json.dumps(finite(data), allow_nan=False))
    else:
        for_people(data)


def show_tables(as_json: bool, data: Data, tabulate: Callable[[Data], Sequence[Table]]) -> None:
    """Print as JSON, or as tables."""
    show(as_json, data, lambda shown: listed(tabulate(shown)))


def listed(tables: Sequence[Table], files: Sequence[Path | str] = ()) -> None:
    """Print tables, with an empty line between two, and the files that were written."""
    console = Terminal()
    for number, table in enumerate(tables):
        if number:
            console.print()
        table.print(console)
    if tables and files:
        console.print()
    for file in files:
        say(f"wrote {file}")


def paper_verdicts(data: Data) -> None:
    """Print the verdicts on the printed equations: what was printed, what is right, and why."""
    colours = {"agrees": "green", "first-order": "yellow", "misprint": "red"}
    console = Terminal()
    for item in data["equations"]:
        verdict = f"[{colours[item['verdict']]}]{item['verdict']}[/]"
        console.print(f"[bold]eq {item['equation']}, {plain(item['row'])}[/]: {verdict}")
        if item["verdict"] != "agrees":
            for label, key in (("printed", "printed"), ("right", "derived"), ("why", "why")):
                console.print(Padding(f"{label}: {plain(item[key])}", (0, 0, 0, 4)))
    count = {name: sum(item["verdict"] == name for item in data["equations"]) for name in colours}
    console.print(", ".join(f"{number} {name}" for name, number in count.items()))


def generated(data: Data) -> None:
    """Print what was generated."""
    for file in data["files"]:
        say(file)
    say(data["library"] or "no library: CasADi's virtual machine")
    say("operations: " + ", ".join(f"{name} {count}" for name, count in data["ops"].items()))
    say("seconds: " + _seconds(data["seconds"]))


def exported_fmu(data: Data) -> None:
    """Print what an FMU has."""
    say(f"{data['file']}: FMI {data['fmi']} {data['kind']}, token {data['token']}")
    say("variables: " + ", ".join(f"{count} {kind}s" for kind, count in data["variables"].items()))
    say("inputs: " + (", ".join(data["inputs"]) or "none"))


def _seconds(seconds: dict[str, float]) -> str:
    """Write stage times on one line."""
    return ", ".join(f"{name} {taken:.2f}" for name, taken in seconds.items())


def pace(factor: float) -> str:
    """Say how fast a simulation ran."""
    if factor >= 1:
        return f"{factor:.1f} times faster than real time"
    return f"{1 / factor:.1f} times slower than real time" if factor > 0 else "stopped at the start"


def simulated(data: Data) -> None:
    """Print the summary of a simulation."""
    console = Terminal()
    listed(list_forces(data))
    for line in data["warnings"]:
        console.print(f"[yellow]warning[/]: {plain(line)}")
    counts = data["counts"]
    expected = counts["expected_events"]
    by = ", as kinematics calls for" if expected == counts["events"] else f", not {expected}"
    console.print(
        f"{data['method']} on {data['engine']}, rtol {data['rtol']:g}: {data['simulated_s']:.6g} s simulated, "
        f"{pace(data['real_time_factor'])}\n"
        f"{counts['steps']} steps, {counts['rhs']} right-hand sides, {counts['jacobian']} Jacobians; "
        f"{counts['events']} stiffness switchings{by}; "
        f"energy balance open by {abs(data['energy_residual']):.1e} of the strain energy\n"
        f"seconds: {_seconds(data['seconds'])}"
    )
    if data["why"]:
        console.print(f"{data['method']}, since {plain(data['why'])}")
    console.print(_sampling(data))
    if "accuracy" in data:
        console.print(_accuracy(data["accuracy"]))


def _sampling(data: Data) -> str:
    """Say how outputs were sampled."""
    since = f", since {plain(data['why_rate'])}" if data["why_rate"] else ""
    band = f"band-limited to {data['band_hz']:.6g} Hz" if "band_hz" in data else "raw, not band-limited"
    return f"{data['rate_hz']:.6g} samples a second{since}; {band}"


def _accuracy(data: Data) -> str:
    """Write the estimate of accuracy, that of the worst mesh."""
    if data["reason"]:
        return f"accuracy of mesh forces not estimated: {plain(data['reason'])}"
    error = data["meshes"][data["worst"]]
    numbers = {key: form(value, ".1e") for key, value in error.items()}
    parts = [
        f"{numbers[f'rms_over_{size}']} rms and {numbers[f'peak_over_{size}']} peak of the {size}"
        for size in ("vibration", "mean")
    ]
    told = {name: max((mesh[name] or 0.0 for mesh in data["meshes"].values()), default=0.0) for name in STATISTICS}
    means = ", ".join(f"{name.replace('_', ' ')} {form(value, '.1e')}" for name, value in told.items())
    worst = f"{plain(data['worst'])}, the worst; first {data['window_s']:.3g} s"
    return (
        f"mesh forces are off by {', '.join(parts)} ({worst})\ntheir statistics, over their size, by at most: {means}"
    )


def costs(data: Data) -> None:
    """Print what the variants of a scene cost, how far their mesh forces are off, and why some did not run."""
    listed(list_costs(data))
    console = Terminal()
    for item in data["variants"]:
        if item["reason"]:
            console.print(f"[yellow]{item['effect']} = {item['without']}[/] did not run: {paragraph(item['reason'])}")


def paper_run(data: Data, tables: dict[str, Table]) -> None:
    """Print the paper's tables with the simulated values, and the place of the figures."""
    listed(tuple(tables.values()))
    simulated(data | {"forces": {}})
    for file in data["files"]:
        say(f"wrote {file}")


def analysed(data: Data, tables: Sequence[Table], files: Sequence[Path]) -> None:
    """Print what a result shows, and what is to be said about it."""
    console = Terminal()
    scene = plain(str(data["scene"] or "no scene"))
    console.print(f"{plain(data['file'])}: {scene}, {data['from_s']:.4g} to {data['to_s']:.4g} s")
    for note in data["notes"]:
        console.print(f"[yellow]note[/]: {plain(note)}")
    listed(tables, files)
