"""What people read on the terminal: rich tables of the same data that --json prints."""

from typing import TYPE_CHECKING, Any

from rich.console import Console
from rich.markup import escape
from rich.padding import Padding
from rich.table import Table

if TYPE_CHECKING:
    from .tables import Table as ResultTable

Data = dict[str, Any]


def _console() -> Console:
    """Return the console; figures are not coloured by guess, long cells wrap."""
    return Console(highlight=False)


def _table(title: str, *columns: str) -> Table:
    """Make a table; columns that begin with ">" are right-aligned."""
    table = Table(title=title, title_justify="left", header_style="bold")
    for column in columns:
        table.add_column(column.lstrip(">"), justify="right" if column.startswith(">") else "left")
    return table


def scenes(data: Data) -> None:
    """Print the shipped scenes."""
    table = _table("Shipped scenes", "scene", "title")
    for item in data["scenes"]:
        table.add_row(item["name"], escape(item["title"]))
    _console().print(table)


def effects(data: Data) -> None:
    """Print the effects."""
    table = _table("Effects (the first value is the default)", "effect", "values", "what it does", "source")
    for item in data["effects"]:
        table.add_row(item["name"], " | ".join(item["values"]), item["help"], item["source"])
    _console().print(table)


def info(data: Data) -> None:
    """Print the description of a model."""
    table = _table(escape(data["title"]), "", "")
    table.add_row("degrees of freedom", str(data["dof"]))
    table.add_row("states", str(data["states"]))
    table.add_row("parameters", str(data["parameters"]))
    table.add_row("switched meshes", str(data["levels"]))
    table.add_row("operations", f"{data['ops']['rhs']} right-hand side, {data['ops']['jacobian']} Jacobian")
    table.add_row("Jacobian non-zeros", str(data["jacobian_nnz"]))
    table.add_row("effects", ", ".join(f"{k} {v}" for k, v in data["effects"].items()))
    for name, force in data["static_mesh_forces_n"].items():
        table.add_row(f"static normal force, {name}", f"{force:.6g} N each mesh")
    for name, ratio in data["speed_ratios"].items():
        table.add_row(f"speed ratio, {name}", f"{ratio:.6g}")
    console = _console()
    console.print(table)
    if "sources" in data:
        listing = _table("Where the numbers come from", "number", "source")
        for key, source in data["sources"].items():
            listing.add_row(escape(key), escape(source))
        console.print(listing)


def checks(data: Data) -> None:
    """Print check results; the notes of all are in --json, those of failures here."""
    table = _table("Checks of the equations", "check", "", ">value", ">tolerance")
    table.columns[0].overflow = "fold"
    for item in data["checks"]:
        mark = "[green]ok[/]" if item["passed"] else "[bold red]FAILED[/]"
        name = escape(item["name"]) + ("" if item["passed"] else f"\n{escape(item['note'])}")
        table.add_row(name, mark, f"{item['value']:.2g}", f"{item['tolerance']:.2g}")
    console = _console()
    console.print(table)
    failed = sum(not item["passed"] for item in data["checks"])
    console.print(f"{len(data['checks']) - failed} passed, {failed} failed; --json tells how each was done")


def paper_verdicts(data: Data) -> None:
    """Print the verdicts on the printed equations: what was printed, what is right, and why."""
    colours = {"agrees": "green", "first-order": "yellow", "misprint": "red"}
    console = _console()
    for item in data["equations"]:
        verdict = f"[{colours[item['verdict']]}]{item['verdict']}[/]"
        console.print(f"[bold]eq {item['equation']}, {escape(item['row'])}[/]: {verdict}")
        if item["verdict"] != "agrees":
            for label, key in (("printed", "printed"), ("right", "derived"), ("why", "why")):
                console.print(Padding(f"{label}: {escape(item[key])}", (0, 0, 0, 4)))
    count = {name: sum(item["verdict"] == name for item in data["equations"]) for name in colours}
    console.print(", ".join(f"{number} {name}" for name, number in count.items()))


def generated(data: Data) -> None:
    """Print what was generated."""
    for file in data["files"]:
        print(file)
    print(data["library"] or "no library: CasADi's virtual machine")
    print("operations: " + ", ".join(f"{name} {count}" for name, count in data["ops"].items()))
    print("seconds: " + _seconds(data["seconds"]))


def _seconds(seconds: dict[str, float]) -> str:
    """Write stage times on one line."""
    return ", ".join(f"{name} {taken:.2f}" for name, taken in seconds.items())


def simulated(data: Data) -> None:
    """Print the summary of a simulation."""
    console = _console()
    if data["forces"]:
        table = _table("Mesh forces, second half of the run", "mesh", ">mean N", ">min N", ">max N", ">load factor")
        for name, force in data["forces"].items():
            row = (f"{force[key]:.5g}" for key in ("mean", "min", "max"))
            table.add_row(name, *row, f"{force['load_factor']:.3f}")
        console.print(table)
    for line in data["warnings"]:
        console.print(f"[yellow]warning[/]: {escape(line)}")
    counts = data["counts"]
    console.print(
        f"{data['method']} on {data['engine']}, rtol {data['rtol']:g}: {data['simulated_s']:.6g} s simulated, "
        f"{data['real_time_factor']:.2f} times real time\n"
        f"{counts['steps']} steps, {counts['rhs']} right-hand sides, {counts['jacobian']} Jacobians; "
        f"{counts['events']} stiffness switchings ({counts['expected_events']} by kinematics); "
        f"energy balance open by {abs(data['energy_residual']):.1e} of the strain energy\n"
        f"seconds: {_seconds(data['seconds'])}"
    )


def modes(data: Data) -> None:
    """Print eigenfrequencies."""
    table = _table("Eigenfrequencies at the loaded equilibrium", ">Hz", ">damping", "class", "kinetic energy")
    for item in data["modes"]:
        energy = ", ".join(f"{name} {share:.0%}" for name, share in list(item["energy"].items())[:3] if share > 0.005)
        table.add_row(f"{item['frequency_hz']:.2f}", f"{item['damping_ratio']:.2%}", item["class"], energy)
    _console().print(table)


def paper_run(data: Data, tables: dict[str, "ResultTable"]) -> None:
    """Print the paper's tables beside the simulated ones, and where the figures are."""
    console = _console()
    for table in tables.values():
        table.print(console)
    simulated(data | {"forces": {}})
    for file in data["files"]:
        console.print(f"wrote {escape(file)}")
