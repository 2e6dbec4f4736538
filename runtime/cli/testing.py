"""Command selftest: the hard cases by every integrator."""

import os
from collections.abc import Mapping
from difflib import get_close_matches
from functools import cache
from typing import TYPE_CHECKING, Annotated

import typer
from ltcgear.generated.errors import LtcgearError

from ..view.tables import printed
from .app import app
from .options import AsJson, FigureFile, Force
from .progress import progress

if TYPE_CHECKING:
    from ..studies.selftest.case import Bench

Full = Annotated[bool, typer.Option("--full", help="The long form: longer runs, some minutes.")]
CaseNames = Annotated[
    list[str] | None, typer.Option("--case", metavar="NAME", help="A case to run.", show_default="all")
]
MethodNames = Annotated[
    list[str] | None, typer.Option("--method", metavar="NAME", help="A method to run.", show_default="all")
]


def open_bench(name: str, changes: Mapping[str, str]) -> "Bench":
    """Build a scene and put it on the test bench; the same scene is built once a process."""
    return _bench(name, tuple(sorted(changes.items())))


@cache
def _bench(name: str, changes: tuple[tuple[str, str], ...]) -> "Bench":
    """Build a scene."""
    from ltcgear.symbolic.assembly import build_model
    from ltcgear.symbolic.emit.pipeline import obtain
    from ltcgear.symbolic.scene.load import load_scene

    from ..model.building import build
    from ..studies.selftest.case import Bench

    model = build_model(load_scene(name, dict(changes)))
    return Bench(build(obtain(model)), model.values(), model.tables)


def choose(wanted: list[str] | None, known: list[str], what: str) -> list[str]:
    """Return the names that were asked for, all where none was; LtcgearError for one that is unknown."""
    for name in wanted or []:
        if name not in known:
            near = get_close_matches(name, known, 1)
            hint = f'did you mean "{near[0]}"?' if near else f"there are {', '.join(known)}"
            raise LtcgearError(f"--{what} {name!r:.60}: unknown; {hint}")
    return [name for name in known if not wanted or name in wanted]


@app.command()
def selftest(
    full: Full = False, case: CaseNames = None, method: MethodNames = None, output: FigureFile = None,
    force: Force = False, as_json: AsJson = False,
) -> None:  # fmt: skip
    """Run the hard cases with every method. Exit code 1 if anything is wrong. With -o, draw the matrix."""
    from ..simulation.methods.registry import METHODS
    from ..studies.selftest.cases import CASES
    from ..studies.selftest.suite import run_suite
    from ..view.figures.cost_figures import check_figure
    from ..view.tables.selftest_tables import draw_matrix, make_table

    names = choose(case, [item.name for item in CASES], "case")
    methods = choose(method, list(METHODS), "method")
    if output is not None:
        check_figure(output)
    chosen = [item for item in CASES if item.name in names]
    total = sum(len(methods) if item.integrates else 1 for item in chosen)
    workers = min(len(os.sched_getaffinity(0)), total)
    with progress("selftest", total, "runs") as told:
        data = run_suite(chosen, methods, open_bench, full=full, workers=workers, told=told)
    printed.show(as_json, data, lambda shown: make_table(shown).print())
    if output is not None:
        draw_matrix(data, output)
    if not data["passed"]:
        raise typer.Exit(1)
