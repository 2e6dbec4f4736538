"""Command sweep: a scene simulated at many points."""

from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from ltcgear.generated.errors import SolverError
from ltcgear.generated.writing import check_output, make_folder

from ..results.terminal import tell
from ..view.tables import printed
from .app import InterruptedRunError, app
from .opening import split_changes
from .options import AsJson, Changes, EndTime, Force, Long, Method, Raw, SamplingRate, SceneName, Tolerance
from .progress import progress

if TYPE_CHECKING:
    from ltcgear.symbolic.emit.template import Template

    from ..studies.sweep.planning import Told

Vary = Annotated[
    list[str],
    typer.Option("--vary", metavar="KEY=VALUES", help="What varies: KEY=a:b:n, KEY=a:b or KEY=v1,v2; once a key."),
]
Sample = Annotated[str, typer.Option("--sample", help="grid, lhs, sobol, normal (KEY=mean:deviation) or saltelli.")]
Points = Annotated[int | None, typer.Option("--points", metavar="N", help="Points to draw.", show_default="the grid's")]
Seed = Annotated[int, typer.Option("--seed", help="Of the random numbers; the same seed gives the same points.")]
Metrics = Annotated[
    list[str] | None,
    typer.Option(
        "--metric", metavar="NAME", show_default="forces, load_share",
        help="What is kept of each run, e.g. rms:acceleration_x:lsp.sun.",
    ),
]  # fmt: skip
Workers = Annotated[int | None, typer.Option("--workers", help="Processes.", show_default="the cores")]
Scheduler = Annotated[
    str | None,
    typer.Option("--scheduler", metavar="ADDRESS", help="Dask scheduler whose workers compute.", show_default="none"),
]
SweepFile = Annotated[Path, typer.Option("-o", "--output", help="NetCDF4 file to write or to go on with, .nc.")]
Retry = Annotated[bool, typer.Option("--retry", help="Compute points that failed before again.")]
Skip = Annotated[
    list[int] | None,
    typer.Option("--skip", metavar="POINT", help="Leave a point out, by its number.", show_default="none"),
]
Figures = Annotated[
    Path | None, typer.Option("--figures", metavar="DIR", help="Folder for figures.", show_default="none")
]

SHOWN = 5
"""Reasons of failed points, and kinds of warnings, that are shown."""


@app.command()
def sweep(
    scene: SceneName,
    vary: Vary,
    output: SweepFile,
    sample: Sample = "grid",
    points: Points = None,
    seed: Seed = 0,
    metric: Metrics = None,
    t_end: EndTime = None,
    rate: SamplingRate = None,
    method: Method = "auto",
    rtol: Tolerance = 1e-6,
    raw: Raw = False,
    workers: Workers = None,
    scheduler: Scheduler = None,
    retry: Retry = False,
    skip: Skip = None,
    long: Long = False,
    figures: Figures = None,
    changes: Changes = None,
    force: Force = False,
    as_json: AsJson = False,
) -> None:
    """Simulate a scene at many points, and keep metrics of each. Run again, it goes on where it was stopped."""
    from ltcgear.symbolic.emit.template import Template

    from ..studies.sweep.run_sweep import sweep as sweep_scene
    from ..studies.sweep.run_sweep import tell_kept

    check_output(output, scene)
    template = Template(scene, split_changes(changes))
    _warn(template)
    if figures is not None:
        make_folder(figures)
    drawn: dict[str, Any] = {"sample": sample, "points": points, "seed": seed}
    runs: dict[str, Any] = {"t_end": t_end, "rate": rate, "method": method, "rtol": rtol, "raw": raw}
    runs |= {"workers": workers, "scheduler": scheduler, "retry": retry, "skip": skip or (), "long": long}
    try:
        with _bars(template.name) as told:
            summary = sweep_scene(template, vary, output, metrics=metric, told=told, **drawn, **runs)
    except KeyboardInterrupt:
        raise InterruptedRunError(f"stopped; {tell_kept(output)}") from None
    if figures is not None:
        summary["figures"] = _draw(output, figures)
    printed.show(as_json, summary, _present)
    if summary["failed"] == summary["points"]:
        raise SolverError(f"all {summary['points']} points failed; {output} has the reasons")


def _warn(template: "Template") -> None:
    """Tell what is doubtful about the scene as it is, where it can be built without being varied."""
    from ltcgear.generated.errors import SceneError
    from ltcgear.symbolic.assembly import build_model
    from ltcgear.symbolic.describe.advice import warnings
    from ltcgear.symbolic.describe.geometry_report import load_warnings

    try:
        scene = template.scene({})
        lines = [*warnings(scene, build_model(scene)), *load_warnings(scene)]
    except SceneError:
        return
    for line in lines:
        tell(f"warning: {template.label}: {line}")


@contextmanager
def _bars(scene: str) -> Iterator["Told"]:
    """Show how far a sweep is, on a terminal: variants that are built, then points."""
    titles = {"build": (f"build {scene}", "variants"), "simulate": (f"sweep {scene}", "points")}
    bars: dict[str, Any] = {}
    with ExitStack() as open_bar:

        def told(stage: str, done: int, total: int, failed: int) -> None:
            if stage not in bars:
                open_bar.close()
                bars[stage] = open_bar.enter_context(progress(titles[stage][0], total, titles[stage][1]))
            bars[stage](done, f"{failed} failed" if failed else "")

        yield told


def _draw(file: Path, folder: Path) -> list[str]:
    """Draw a sweep into a folder; return the files."""
    from ..studies.sweep.sweep_file import load_sweep
    from ..view.figures.sweep_figures import draw_sweep
    from ..view.plots import save_figure

    files = []
    for name, figure in draw_sweep(load_sweep(file)).items():
        files.append(str(folder / f"{name}.svg"))
        save_figure(figure, folder / f"{name}.svg")
    return files


def _present(summary: dict[str, Any]) -> None:
    """Print a sweep for people."""
    from ..studies.sweep.sweep_file import load_sweep
    from ..view.tables.sweep_tables import list_tables

    figures = [Path(file) for file in summary.get("figures", [])]
    printed.listed(list_tables(load_sweep(Path(summary["file"]))), figures)
    for note in summary["notes"]:
        print(note)
    for word, told in (("failed", summary["reasons"]), ("warned", summary["warnings"])):
        for text, count in list(told.items())[:SHOWN]:
            print(f"{word}, {count} of {summary['points']}: {text}")
        if len(told) > SHOWN:
            print(f"{word}: {len(told) - SHOWN} more kinds; the file has all")
    kept = f", {summary['kept']} were there" if summary["kept"] else ""
    done = f"{summary['computed']} points computed" if summary["computed"] else "finished before, nothing computed"
    warned = f", {summary['warned']} warned" if summary["warned"] else ""
    print(f"{done}{kept}; {summary['failed']} failed{warned}; {summary['file']}")
