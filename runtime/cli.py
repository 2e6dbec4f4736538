"""The command line, the one place that knows all three parts: scene -> model -> C -> results."""

import sys
from dataclasses import asdict, dataclass, field
from pathlib import Path
from time import perf_counter
from typing import TYPE_CHECKING, Annotated, Any, cast

import typer
from ltcgear.generated import store
from ltcgear.generated.contract import Artifact
from ltcgear.generated.errors import LtcgearError, SolverError

from . import present
from .options import (
    SHORTEST_PAPER,
    AsJson,
    CFolder,
    Changes,
    CostEnd,
    EndTime,
    FigureFile,
    Fresh,
    MaybeScene,
    Method,
    Oversample,
    PaperEnd,
    Printed,
    ResultFile,
    ResultFolder,
    SceneName,
    Sources,
    Tolerance,
)
from .progress import progress

if TYPE_CHECKING:
    from ltcgear.symbolic.model import Model
    from ltcgear.symbolic.schema import Scene

    from .cost import Variant
    from .library import Library

# Plain help: rich would take "[s]" for markup and drop it.
app = typer.Typer(no_args_is_help=True, add_completion=False, pretty_exceptions_enable=False, rich_markup_mode=None)
#: What typer raises for a command line that it cannot read; BadParameter alone of the family is public.
UsageError = cast(type[typer.BadParameter], typer.BadParameter.__base__)
INTERRUPTED = 130


class InterruptedRunError(LtcgearError):
    """The user stopped a simulation; what it had computed is kept."""

    exit_code = INTERRUPTED


@dataclass
class Opened:
    """A scene on its way through the house, with the seconds each stage took."""

    scene: "Scene"
    model: "Model"
    artifact: Artifact
    key: str
    seconds: dict[str, float] = field(default_factory=dict)


def _changes(pairs: list[str] | None) -> dict[str, str]:
    """Split KEY=VALUE pairs."""
    split = [pair.partition("=") for pair in pairs or []]
    bad = [key for key, sign, _ in split if not sign or not key]
    if bad:
        raise LtcgearError(f"--set {bad[0]}: write KEY=VALUE, for example loads.motor.speed='10 rpm'")
    return {key: value for key, _, value in split}


def open_scene(name: str, changes: list[str] | None = None, fresh: bool = False) -> Opened:
    """Take a scene through all stages up to generated C; what the store holds is not derived again.

    scene -> Model -> (derive -> check -> emit, or the store) -> Artifact
    """
    from ltcgear.symbolic.advice import warnings
    from ltcgear.symbolic.build import build_model
    from ltcgear.symbolic.pipeline import content_key, obtain
    from ltcgear.symbolic.report import load_warnings
    from ltcgear.symbolic.scene import load_scene

    clock = perf_counter()
    scene = load_scene(name, _changes(changes))
    model = build_model(scene)
    seconds = {"load": perf_counter() - clock}
    for line in [*warnings(scene, model), *load_warnings(scene)]:
        print(f"ltcgear: warning: {name}: {line}", file=sys.stderr)
    artifact = obtain(model, lambda stage, taken: seconds.update({stage: taken}), fresh)
    return Opened(scene, model, artifact, content_key(model), seconds)


def compile_model(opened: Opened) -> "Library":
    """Compile and load a generated model; without a compiler this is said in one line."""
    from .library import NO_COMPILER, build

    clock = perf_counter()
    library = build(opened.artifact)
    opened.seconds["compile"] = perf_counter() - clock
    if library.path is None:
        print(NO_COMPILER, file=sys.stderr)
    return library


def _version(wanted: bool) -> None:
    """Print the version and stop."""
    if wanted:
        from importlib.metadata import version

        print(f"ltcgear {version('ltcgear')}")
        raise typer.Exit


@app.callback()
def common(
    version: Annotated[
        bool, typer.Option("--version", callback=_version, is_eager=True, help="Print the version and stop.")
    ] = False,
) -> None:
    """Gearbox dynamics from written equations: scenes to C to simulations and eigenfrequencies."""


@app.command()
def scenes(as_json: AsJson = False) -> None:
    """List the shipped scenes."""
    from ltcgear.symbolic.scene import load_scene, shipped_scenes

    listed = [{"name": name, "title": load_scene(name).title} for name in shipped_scenes()]
    present.show(as_json, {"scenes": listed}, present.scenes)


@app.command()
def effects(as_json: AsJson = False) -> None:
    """List the effects a scene can call for."""
    from ltcgear.symbolic.effect_page import list_effects

    present.show(as_json, {"effects": list_effects()}, present.effects)


@app.command()
def info(scene: SceneName, sources: Sources = False, changes: Changes = None, as_json: AsJson = False) -> None:
    """Describe a scene: freedoms, geometry, motion, forces, loads."""
    from ltcgear.symbolic.overview import survey

    opened = open_scene(scene, changes)
    data = survey(opened.scene, opened.model, opened.artifact.manifest)
    if sources:
        data["sources"] = dict(opened.scene.sources)
    present.show(as_json, data, present.info)


@app.command()
def check(scene: MaybeScene = None, paper: Printed = False, changes: Changes = None, as_json: AsJson = False) -> None:
    """Check a scene's equations, or those the paper prints. Exit code 1 if a check fails."""
    if paper and scene is not None:
        raise LtcgearError(f"check: both {scene} and --paper were given; give one of them")
    if not paper and scene is None:
        raise LtcgearError("check: give a SCENE, or --paper")
    if paper:
        from ltcgear.symbolic.checks.paper import check_paper

        present.show(as_json, {"equations": [asdict(verdict) for verdict in check_paper()]}, present.paper_verdicts)
        return
    from ltcgear.symbolic.build import build_model
    from ltcgear.symbolic.checks.run import check_model
    from ltcgear.symbolic.scene import load_scene

    results = check_model(build_model(load_scene(scene or "", _changes(changes))))
    listed = [asdict(result) for result in results]
    passed = all(item["passed"] for item in listed)
    present.show(as_json, {"passed": passed, "checks": listed}, present.checks)
    if not passed:
        raise typer.Exit(1)


@app.command()
def generate(
    scene: SceneName, output: CFolder = None, fresh: Fresh = False, changes: Changes = None, as_json: AsJson = False
) -> None:
    """Derive, check, emit and compile a scene's C. It is kept in the store; -o makes a copy."""
    opened = open_scene(scene, changes, fresh)
    library = compile_model(opened)
    files = store.files(opened.artifact)
    del files["graphs.casadi"]
    folder = output or store.model_folder(opened.key)
    if output is not None:
        store.write_folder(output, files)
    ops = {name: signature.operations for name, signature in opened.artifact.manifest.functions.items()}
    data = {
        "files": [str(folder / name) for name in files],
        "library": str(library.path) if library.path else None,
        "ops": ops,
        "seconds": dict.fromkeys(("derive", "check", "emit"), 0.0) | opened.seconds,
        "key": opened.key,
    }
    present.show(as_json, data, present.generated)


@app.command()
def simulate(
    scene: SceneName,
    output: ResultFile = None,
    t_end: EndTime = None,
    method: Method = "erk",
    rtol: Tolerance = 1e-6,
    oversample: Oversample = 1,
    changes: Changes = None,
    as_json: AsJson = False,
) -> None:
    """Simulate a scene from its loaded equilibrium. With -o, write the result as NetCDF4."""
    summary = run(scene, changes, output, t_end, method, rtol, oversample)
    present.show(as_json, summary, present.simulated)
    _finished(summary)


def _finished(summary: dict[str, Any]) -> None:
    """Stop with the reason, where a simulation did not reach its end."""
    status = summary["status"]
    if status != "done":
        raise (InterruptedRunError if status.startswith("interrupted") else SolverError)(status)


def _check_result(output: Path) -> None:
    """Refuse a result file that cannot be written or is not named .nc, before anything is computed."""
    from .results import check_target

    check_target(output)
    if output.suffix != ".nc":
        raise LtcgearError(f"{output}: results are NetCDF4 files; name it {output.with_suffix('.nc')}")


def run(
    scene: str,
    changes: list[str] | None,
    output: Path | None,
    t_end: float | None,
    method: str,
    rtol: float,
    oversample: int,
) -> dict[str, Any]:
    """Simulate a scene and write its result; return the summary."""
    from .results import save
    from .simulation import check_options
    from .simulation import simulate as simulate_model

    check_options(method, rtol, t_end)
    if output is not None:
        _check_result(output)
    opened = open_scene(scene, changes)
    library = compile_model(opened)
    end = t_end if t_end is not None else opened.scene.simulation.t_end
    about = {"scene": opened.scene.name, "title": opened.scene.title}
    with progress(f"simulate {opened.scene.name}", end) as told:
        result = simulate_model(
            library,
            opened.model.values(),
            t_end=end,
            rate=opened.scene.simulation.rate,
            method=method,
            rtol=rtol,
            oversample=oversample,
            attributes=about | {"scene_json": opened.scene.model_dump_json()},
            told=told,
            tables=opened.model.tables,
        )
    seconds = opened.seconds | result.summary["seconds"]
    if output is not None:
        clock = perf_counter()
        save(result.dataset, output)
        seconds["write"] = perf_counter() - clock
    return {"scene": opened.scene.name, **result.summary, "seconds": seconds}


@app.command()
def modes(scene: SceneName, changes: Changes = None, as_json: AsJson = False) -> None:
    """List eigenfrequencies and damping at the loaded equilibrium."""
    from .equilibrium import find_equilibrium
    from .modes import find_modes

    opened = open_scene(scene, changes)
    library = compile_model(opened)
    p = library.parameters(opened.model.values())
    found = find_modes(library, find_equilibrium(library, p, tables=opened.model.tables), p)
    listed = [
        {
            "frequency_hz": m.frequency_hz,
            "damping_ratio": m.damping_ratio,
            "class": m.kind,
            "energy": m.energy,
        }
        for m in found
    ]
    present.show(as_json, {"scene": opened.scene.name, "modes": listed}, present.modes)


@app.command()
def cost(
    scene: SceneName,
    output: FigureFile = None,
    t_end: CostEnd = 0.25,
    rtol: Tolerance = 1e-6,
    changes: Changes = None,
    as_json: AsJson = False,
) -> None:
    """Show what each effect of a scene costs, and how far the mesh forces are off without it. With -o, draw it."""
    from .cost import ROUNDS, measure_costs
    from .cost_figure import check_figure, draw_costs
    from .simulation import DEFAULT_METHOD, check_options

    check_options(DEFAULT_METHOD, rtol, t_end)
    if output is not None:
        check_figure(output)
    opened = open_scene(scene, changes)
    variants = _variants(scene, _changes(changes), opened)
    rate = opened.scene.simulation.rate
    with progress(f"simulate {opened.scene.name}", ROUNDS * len(variants) * t_end) as told:
        rows = measure_costs(variants, t_end=t_end, rate=rate, rtol=rtol, told=told)
    data = {"scene": opened.scene.name, "t_end": t_end, "rtol": rtol, "variants": rows}
    present.show(as_json, data, present.costs)
    if output is not None:
        draw_costs(data, output)


def _variants(name: str, changes: dict[str, str], opened: Opened) -> "list[Variant]":
    """Build a scene and what it is with each of its effects left out; what is not possible keeps its reason."""
    from ltcgear.symbolic.build import build_model
    from ltcgear.symbolic.pipeline import obtain
    from ltcgear.symbolic.scene import load_scene
    from ltcgear.symbolic.variants import list_changes

    from .cost import Variant
    from .library import build

    found = list_changes(opened.scene, opened.model)
    variants = [Variant("all", "", "", compile_model(opened), opened.model.values(), tables=opened.model.tables)]
    with progress(f"build {opened.scene.name}", len(found), "variants") as told:
        for k, item in enumerate(found, start=1):
            key = (item.effect, item.value, item.without)
            try:
                model = build_model(load_scene(name, changes | {f"effects.{item.effect}": item.without}))
                made = Variant(*key, build(obtain(model)), model.values(), tables=model.tables)
            except LtcgearError as error:
                made = Variant(*key, None, {}, str(error))
            variants.append(made)
            told(k)
    return variants


@app.command()
def paper(
    output: ResultFolder = Path("out"),
    t_end: PaperEnd = 4.0,
    method: Method = "erk",
    changes: Changes = None,
    as_json: AsJson = False,
) -> None:
    """Simulate the paper's test rig. Sets its tables and figures beside the printed ones."""
    from .comparison import compare
    from .plots import overview_figure, paper_figures
    from .results import load, make_folder

    if not t_end >= SHORTEST_PAPER:
        raise LtcgearError(f"--t-end {t_end:g}: the paper's tables need {SHORTEST_PAPER} s at least")
    make_folder(output)
    file = output / "rig-2mw.nc"
    summary = run("rig-2mw", changes, file, t_end, method, 1e-6, oversample=8)
    _finished(summary)
    dataset = load(file)
    tables = compare(dataset)
    figures = [*paper_figures(dataset, output), overview_figure(dataset, output / "overview.png")]
    data = {
        **summary,
        "tables": {name: table.to_json() for name, table in tables.items()},
        "files": [str(file), *(str(figure) for figure in figures)],
    }
    present.show(as_json, data, lambda shown: present.paper_run(shown, tables))


def main() -> None:
    """Run the command line; errors become one message and an exit code."""
    try:
        code = app(standalone_mode=False) or 0
        if code == INTERRUPTED:  # what typer makes of a KeyboardInterrupt; older ones abort
            raise KeyboardInterrupt
    except LtcgearError as error:
        print(f"ltcgear: {error}", file=sys.stderr)
        code = error.exit_code
    except UsageError as error:
        error.show()
        code = error.exit_code
    except (KeyboardInterrupt, typer.Abort):
        print("ltcgear: stopped; nothing half-written was left", file=sys.stderr)
        code = INTERRUPTED
    sys.exit(code)
