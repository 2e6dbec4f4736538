"""Commands simulate and cost."""

from pathlib import Path
from typing import Any

import typer
from ltcgear.generated.errors import LtcgearError, SolverError

from ..view.tables import printed
from .app import InterruptedRunError, app
from .measuring import check_accuracy, find_setting
from .opening import compile_model, open_scene, open_variants, rate_of, split_changes
from .options import (
    Accuracy,
    AsJson,
    Changes,
    CostEnd,
    EndTime,
    FigureFile,
    Force,
    Long,
    Method,
    Raw,
    RecordFile,
    ResultFile,
    Resume,
    SamplingRate,
    SceneName,
    Tolerance,
    Verify,
)
from .progress import progress


@app.command()
def simulate(
    context: typer.Context,
    scene: SceneName,
    output: ResultFile = None,
    t_end: EndTime = None,
    rate: SamplingRate = None,
    method: Method = "auto",
    rtol: Tolerance = 1e-6,
    raw: Raw = False,
    resume: Resume = False,
    verify: Verify = False,
    accuracy: Accuracy = None,
    record: RecordFile = None,
    long: Long = False,
    changes: Changes = None,
    force: Force = False,
    as_json: AsJson = False,
) -> None:
    """Simulate a scene from its loaded equilibrium. With -o, write the result as NetCDF4, as it comes."""
    sources = {name: context.get_parameter_source(name) for name in ("method", "rtol")}
    given = [f"--{name}" for name, source in sources.items() if source and source.name == "COMMANDLINE"]
    check_accuracy(accuracy, record, given)
    summary = run(scene, changes, output, t_end, method, rtol, raw, resume, verify, accuracy, record, long, rate)
    printed.show(as_json, summary, printed.simulated)
    finished(summary)


def finished(summary: dict[str, Any]) -> None:
    """Stop with the reason, where a simulation did not reach its end."""
    status = summary["status"]
    if status != "done":
        raise (InterruptedRunError if status.startswith("interrupted") else SolverError)(status)


def _check_result(output: Path | None, resume: bool, *sources: Path | str | None) -> None:
    """Refuse a result file that cannot be written or gone on with, before anything is computed."""
    from ..simulation.recording import check_recordable

    if output is not None:
        check_recordable(output, resume, *sources)
    elif resume:
        raise LtcgearError("--resume: say which result is to go on, -o FILE.nc")


def run(
    scene: str,
    changes: list[str] | None,
    output: Path | None,
    t_end: float | None,
    method: str,
    rtol: float,
    raw: bool = False,
    resume: bool = False,
    verify: bool = False,
    accuracy: str | None = None,
    record_file: Path | None = None,
    long: bool = False,
    rate: float | None = None,
) -> dict[str, Any]:
    """Simulate a scene, into a file where one is given; return the summary."""
    from ..simulation.recording import record
    from ..simulation.run_settings import check_options
    from ..simulation.simulate import simulate as simulate_model

    check_options(method, rtol, t_end, rate)
    _check_result(output, resume, scene, record_file)
    opened = open_scene(scene, changes, output)
    library = compile_model(opened)
    end = t_end if t_end is not None else opened.scene.simulation.t_end
    about = dict(opened.about)
    told_of: dict[str, Any] = {}
    if accuracy is not None:
        setting = find_setting(opened, library, accuracy, record_file)
        method, rtol = setting.method, setting.rtol
        told_of = {"why": setting.why, "setting": setting.to_json()}
        about["setting"] = told_of["setting"]
    with progress(f"simulate {opened.scene.name}", end) as told:
        options: dict[str, Any] = {
            "t_end": end,
            "rate": opened.scene.simulation.rate if rate is None else rate,
            "method": method,
            "rtol": rtol,
            "raw": raw,
            "attributes": about,
            "told": told,
            "tables": opened.model.tables,
            "verify": verify,
            "long": long,
        }
        if output is None:
            summary = simulate_model(library, opened.model.values(), **options).summary
            if summary["status"].startswith("interrupted"):
                summary["status"] += "; nothing is kept without -o"
        else:
            summary = record(library, opened.model.values(), output, resume=resume, **options)
    return {"scene": opened.scene.name, **summary, **told_of, "seconds": opened.seconds | summary["seconds"]}


@app.command()
def cost(
    scene: SceneName,
    output: FigureFile = None,
    t_end: CostEnd = 0.25,
    rtol: Tolerance = 1e-6,
    changes: Changes = None,
    force: Force = False,
    as_json: AsJson = False,
) -> None:
    """Show what each effect of a scene costs, and how far the mesh forces are off without it. With -o, draw it."""
    from ..simulation.run_settings import check_options
    from ..studies.cost import ROUNDS, measure_costs
    from ..view.figures.cost_figures import check_figure, draw_costs

    check_options("erk", rtol, t_end)
    if output is not None:
        check_figure(output, scene)
    opened = open_scene(scene, changes, output)
    variants = open_variants(split_changes(changes), opened)
    rate = rate_of(opened, compile_model(opened))
    with progress(f"simulate {opened.scene.name}", ROUNDS * len(variants) * t_end) as told:
        rows = measure_costs(variants, t_end=t_end, rate=rate, rtol=rtol, told=told)
    data = {"scene": opened.scene.name, "t_end": t_end, "rtol": rtol, "variants": rows}
    printed.show(as_json, data, printed.costs)
    if output is not None:
        draw_costs(data, output)
