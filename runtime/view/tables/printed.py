"""Terminal output of commands: one JSON object, or tables of the same data."""

import json
import math
from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any

from rich.box import SIMPLE_HEAD
from rich.padding import Padding
from rich.table import Table

from ...results.attributes import finite
from ...results.terminal import Terminal, paragraph, plain, say

if TYPE_CHECKING:
    from pathlib import Path

    from ...results.table import Table as ResultTable

Data = dict[str, Any]
STATISTICS = ("mean", "rms", "load_factor")
"""Statistics whose accuracy is told."""


def show(as_json: bool, data: Data, for_people: Callable[[Data], None]) -> None:
    """Print as JSON, or for people."""
    if as_json:
        print(json.dumps(finite(data), allow_nan=False))
    else:
        for_people(data)


def new_table(title: str, *columns: str) -> Table:
    """Make a table; columns that begin with ">" are right-aligned. Long cells fold, nothing is cut."""
    table = Table(
        title=title,
        title_justify="left",
        header_style="bold",
        box=SIMPLE_HEAD,
        pad_edge=False,
        show_edge=False,
        show_header=any(columns),
    )
    for column in columns:
        table.add_column(column.lstrip(">"), justify="right" if column.startswith(">") else "left", overflow="fold")
    return table


def scenes(data: Data) -> None:
    """Print the shipped scenes."""
    table = new_table("Shipped scenes", "scene", "title")
    for item in data["scenes"]:
        table.add_row(item["name"], plain(item["title"]))
    Terminal().print(table)


def effects(data: Data) -> None:
    """Print the effects."""
    table = new_table("Effects (the first value is the default)", "effect", "values", "what it does", "source")
    for item in data["effects"]:
        does = "\n".join(map(plain, [item["help"], *_conditions(item)]))
        table.add_row(item["name"], _values(item), does, item["source"])
    Terminal().print(table)


def _values(item: Data) -> str:
    """Write the values of an effect, the default first."""
    return " | ".join([item["default"], *(value for value in item["values"] if value != item["default"])])


def _conditions(item: Data) -> Iterator[str]:
    """Write what the values of an effect need and exclude."""
    for value, need in item["needs"].items():
        yield f"{value}: needs {need}"
    for value, exclusions in item["excludes"].items():
        for other in exclusions:
            yield f"{value}: not beside {other['effect']} = {' or '.join(other['values'])}, since {other['reason']}"


def info(data: Data) -> None:
    """Print the description of a model."""
    table = new_table(plain(data["title"]), "", "")
    table.add_row("degrees of freedom", str(data["dof"]))
    table.add_row("states", str(data["states"]))
    table.add_row("parameters", str(data["parameters"]))
    table.add_row("switched meshes", str(data["levels"]))
    table.add_row("operations", f"{data['ops']['rhs']} right-hand side, {data['ops']['jacobian']} Jacobian")
    table.add_row("Jacobian non-zeros", str(data["jacobian_nnz"]))
    table.add_row("effects", ", ".join(f"{k} {v}" for k, v in data["effects"].items()))
    console = Terminal()
    parts = [table, *(made(data) for made in (_acting, _freedoms, _stages, _meshes, _members, _loads, _laws))]
    for part in parts:
        if part.row_count:
            console.print(part, "")
    if "sources" in data:
        _sources(console, data["sources"])


def _acting(data: Data) -> Table:
    """List the effects that are on and what each does here."""
    table = new_table("Effects that act", "effect", "value", "what the model has by it")
    for item in data["acting"]:
        table.add_row(item["effect"], item["value"], item["here"])
    return table


def _freedoms(data: Data) -> Table:
    """List the coordinates and why each is there."""
    table = new_table("Freedoms", "body", "axes", "why")
    for row in data["freedoms"]:
        table.add_row(row["body"], ", ".join(row["axes"]), row["reason"])
    return table


def _number(value: float | None, form: str) -> str:
    """Write a number; a dash for one that is not known."""
    return "-" if value is None else format(value, form)


def _stages(data: Data) -> Table:
    """List geometry and mesh frequency of the stages; overlapping planet tips are marked."""
    table = new_table("Stages", "stage", "", "")
    for name, stage in data["stages"].items():
        radii = ", ".join(f"{part} {radius:.3f}" for part, radius in stage["base_radii_mm"].items())
        table.add_row(name, "centre distance", f"{stage['center_distance_mm']:.3f} mm")
        table.add_row("", "base radii", f"{radii} mm")
        if stage["mesh_frequency_hz"] is not None:
            table.add_row("", "mesh frequency", f"{stage['mesh_frequency_hz']:.3f} Hz")
        clearance = stage["planet_tip_clearance_mm"]
        if clearance is not None:
            mark = "[yellow]{}[/]" if clearance < 0 else "{}"
            table.add_row("", "tip clearance of planets", mark.format(f"{clearance:.3f} mm (full-depth teeth)"))
    return table


def _meshes(data: Data) -> Table:
    """List angle, contact ratio, stiffness and static normal force of the meshes."""
    table = new_table(
        "Meshes (force: static and normal, in each such mesh)",
        "mesh", ">angle deg", ">contact ratio", ">single N/m", ">double N/m", ">force N",
    )  # fmt: skip
    for name, stage in data["stages"].items():
        for key, mesh in stage["meshes"].items():
            given = " given" if mesh["contact_ratio_given"] else ""
            table.add_row(
                f"{name}.{key}",
                f"{mesh['pressure_angle_deg']:.3f}",
                _number(mesh["contact_ratio"], ".3f") + given,
                _number(mesh["stiffness_single_n_per_m"], ".4g"),
                _number(mesh["stiffness_double_n_per_m"], ".4g"),
                f"{mesh['static_force_n']:.6g}",
            )
    return table


def _members(data: Data) -> Table:
    """List motion and inertia of the members."""
    table = new_table("Members", "member", ">r/min", ">speed ratio", ">mass kg", ">inertia kg m^2")
    for name, member in data["members"].items():
        table.add_row(
            name if member["count"] == 1 else f"{name} (each of {member['count']})",
            f"{member['speed_rpm']:.3f}",
            _number(data["speed_ratios"].get(name), ".6g"),
            _number(member["mass_kg"], ".5g"),
            _number(member["inertia_kg_m2"], ".5g"),
        )
    return table


def _loads(data: Data) -> Table:
    """List the loads: what drives and what brakes."""
    table = new_table("Loads (without losses)", "load", "member", ">r/min", ">torque N m", ">power kW", "")
    for name, load in data["loads"].items():
        numbers = (_number(load[key], form) for key, form in (("torque_n_m", ".6g"), ("power_kw", "+.6g")))
        table.add_row(name, load["member"], f"{load['speed_rpm']:.3f}", *numbers, load["action"])
    return table


def _laws(data: Data) -> Table:
    """List how loads vary."""
    table = new_table("Loads that vary (above at their largest, or at the speeds listed)", "load", "")
    for name, load in data["loads"].items():
        if load["law"]:
            table.add_row(name, load["law"])
    return table


def _sources(console: Terminal, sources: dict[str, str]) -> None:
    """List where the numbers come from."""
    if not sources:
        console.print("no sources given")
        return
    listing = new_table("Where the numbers come from", "number", "source")
    for key, source in sources.items():
        listing.add_row(plain(key), plain(source))
    console.print(listing)


def checks(data: Data) -> None:
    """Print check results; the notes of all are in --json, those of failures here."""
    table = new_table("Checks of the equations", "check", "", ">value", ">tolerance")
    for item in data["checks"]:
        mark = "[green]ok[/]" if item["passed"] else "[bold red]FAILED[/]"
        name = plain(item["name"]) + ("" if item["passed"] else f"\n{plain(item['note'])}")
        table.add_row(name, mark, f"{item['value']:.2g}", f"{item['tolerance']:.2g}")
    console = Terminal()
    console.print(table)
    failed = sum(not item["passed"] for item in data["checks"])
    console.print(f"{len(data['checks']) - failed} passed, {failed} failed; --json tells how each was done")


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
    if data["forces"]:
        table = new_table("Mesh forces, second half of the run", "mesh", ">mean N", ">min N", ">max N", ">load factor")
        for name, force in data["forces"].items():
            row = (f"{force[key]:.5g}" for key in ("mean", "min", "max"))
            factor = force["load_factor"]
            table.add_row(name, *row, "-" if math.isnan(factor) else f"{factor:.3f}")
        console.print(table)
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
    numbers = {key: _number(value, ".1e") for key, value in error.items()}
    parts = [
        f"{numbers[f'rms_over_{size}']} rms and {numbers[f'peak_over_{size}']} peak of the {size}"
        for size in ("vibration", "mean")
    ]
    told = {name: max((mesh[name] or 0.0 for mesh in data["meshes"].values()), default=0.0) for name in STATISTICS}
    means = ", ".join(f"{name.replace('_', ' ')} {_number(value, '.1e')}" for name, value in told.items())
    worst = f"{plain(data['worst'])}, the worst; first {data['window_s']:.3g} s"
    return (
        f"mesh forces are off by {', '.join(parts)} ({worst})\ntheir statistics, over their size, by at most: {means}"
    )


def costs(data: Data) -> None:
    """Print what the variants of a scene cost, and how far their mesh forces are from the full one's."""
    title = "Cost (operations of right-hand side and Jacobian; ns a right-hand side; s a simulated s)"
    cost = new_table(title, "left out", ">states", ">rhs", ">Jac.", ">ns", ">s/s", ">steps", ">jumps")
    change = new_table("Change of mesh forces, worst stage", "left out", ">rms", ">peak", ">share", ">spectrum")
    for table in (cost, change):
        table.columns[0].no_wrap = True
    for item in data["variants"]:
        name = f"{item['effect']}\n  {item['value']} > {item['without']}" if item["without"] else "nothing"
        numbers = [item["states"], item["ops"]["rhs"], item["ops"]["jacobian"]]
        times = [_number(item["ns_call"], ".0f"), _number(item["seconds_per_simulated_second"], ".3f")]
        counts = [item["counts"].get(key) for key in ("steps", "events")]
        cost.add_row(name, *(_number(n, "d") for n in numbers), *times, *(_number(n, "d") for n in counts))
        change.add_row(name, *(_change(value) for value in item["changes"].values()))
    console = Terminal()
    console.print(cost, "", change)
    for item in data["variants"]:
        if item["reason"]:
            console.print(f"[yellow]{item['effect']} = {item['without']}[/] did not run: {paragraph(item['reason'])}")


def _change(value: float | None) -> str:
    """Write a relative change; rounding has no sign."""
    return "-" if value is None else f"{value:+.2%}" if abs(value) >= 5e-5 else "0"


def listed(tables: "list[ResultTable]", files: "list[Path]") -> None:
    """Print tables, and the files that were written."""
    console = Terminal()
    for table in tables:
        table.print(console)
        console.print()
    for file in files:
        say(f"wrote {file}")


def paper_run(data: Data, tables: dict[str, "ResultTable"]) -> None:
    """Print the paper's tables with the simulated values, and the place of the figures."""
    console = Terminal()
    for table in tables.values():
        table.print(console)
    simulated(data | {"forces": {}})
    for file in data["files"]:
        say(f"wrote {file}")


def analysed(data: Data, tables: "list[ResultTable]", files: "list[Path]") -> None:
    """Print what a result shows, and what is to be said about it."""
    console = Terminal()
    scene = plain(str(data["scene"] or "no scene"))
    console.print(f"{plain(data['file'])}: {scene}, {data['from_s']:.4g} to {data['to_s']:.4g} s")
    for note in data["notes"]:
        console.print(f"[yellow]note[/]: {plain(note)}")
    listed(tables, files)
