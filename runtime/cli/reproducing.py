"""Command paper: the paper reproduced on one page."""

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from ltcgear.generated.errors import LtcgearError
from ltcgear.generated.writing import is_forced, make_folder

from ..view.tables import printed
from . import running
from .app import app
from .linear import open_linear
from .opening import compile_model, open_scene, split_changes
from .options import SHORTEST_PAPER, AsJson, Changes, Force, Method, PaperEnd, ResultFolder

if TYPE_CHECKING:
    from ..linear.modes import Mode
    from ..linear.system import Linear
    from ..results.result import Result

Quick = Annotated[
    bool, typer.Option("--quick", help="The rig as assumed only: tables and figures, no page and no fitted rig.")
]
RIGS = {"assumed": "rig-2mw", "fitted": "rig-2mw-fitted"}
FLOATING = {"sun floats": "floating-on", "sun on a stiff bearing": "floating-off"}
SUN_MESHES = "lsp.sun_planet"
STEP, STEP_END = 0.5, 2.5


@app.command()
def paper(
    output: ResultFolder = Path("out"),
    t_end: PaperEnd = 4.0,
    method: Method = "erk",
    quick: Quick = False,
    changes: Changes = None,
    force: Force = False,
    as_json: AsJson = False,
) -> None:
    """Reproduce the paper: its tables and figures beside the simulated ones, on one page (paper.html)."""
    from ..results.result import load
    from ..simulation.run_settings import check_options
    from ..studies.wu2021.comparison import compare
    from ..view.plots import overview_figure, paper_figures
    from ..view.wu2021.paper_page import check_page

    if not t_end >= SHORTEST_PAPER:
        raise LtcgearError(f"--t-end {t_end:g}: the paper's tables need {SHORTEST_PAPER} s at least")
    check_options(method, 1e-6, t_end)
    if not quick:
        check_page()
        _full_torque(changes)
    make_folder(output)
    rigs = {"assumed": RIGS["assumed"]} if quick else RIGS
    summaries, results = {}, {}
    for rig, scene in rigs.items():
        file = output / f"{scene}.nc"
        summaries[rig] = running.run(scene, changes, file, t_end, method, 1e-6, resume=_is_begun(file))
        running.finished(summaries[rig])
        results[rig] = load(file)
    dataset = results["assumed"].dataset
    tables = compare(dataset)
    figures = [*paper_figures(dataset, output), overview_figure(dataset, output / "overview.png")]
    pages = [] if quick else [_write_page(results, changes, output / "paper.html")]
    data = {
        **summaries["assumed"],
        "tables": {name: table.to_json() for name, table in tables.items()},
        "files": [*(str(output / f"{scene}.nc") for scene in rigs.values()), *map(str, [*figures, *pages])],
    }
    printed.show(as_json, data, lambda shown: printed.paper_run(shown, tables))


def _is_begun(file: Path) -> bool:
    """Say whether a run was stopped or killed that the same command goes on with."""
    from ..results.checkpoint import checkpoint_of
    from ..results.row_file import part_of

    return part_of(file).is_file() and checkpoint_of(file).is_file() and not is_forced()


def _write_page(results: Mapping[str, "Result"], changes: list[str] | None, path: Path) -> Path:
    """Compute what the page shows beside the long runs, and write it."""
    from ..view.wu2021.paper_page import PageContent, write_page

    linears = {rig: _linear(scene, changes) for rig, scene in RIGS.items()}
    material = PageContent(
        datasets={rig: result.dataset for rig, result in results.items()},
        linears={rig: linear for rig, (linear, _) in linears.items()},
        modes={rig: modes for rig, (_, modes) in linears.items()},
        transient=_transient(changes),
        step_s=STEP,
        shares={name: _shares(scene) for name, scene in FLOATING.items()},
        changes=tuple(changes or ()),
    )
    return write_page(material, path)


def _linear(scene: str, changes: list[str] | None) -> tuple["Linear", list["Mode"]]:
    """Linearise a rig at its loaded equilibrium and find its modes."""
    from ..linear.modes import find_modes
    from ..linear.naming import describe_modes

    linear = open_linear(open_scene(scene, changes))
    return linear, describe_modes(linear, find_modes(linear))


def _full_torque(changes: list[str] | None) -> float:
    """Return the generator's torque in the scene [N m], the end of the page's step."""
    from ltcgear.symbolic.scene.load import load_scene

    torque = load_scene(RIGS["assumed"], split_changes(changes)).loads["generator"].torque
    if torque is None:
        raise LtcgearError(
            "loads.generator: gives no torque, and the page steps it from a half to the whole; give torque, "
            "or take --quick, which has no page"
        )
    return torque


def _transient(changes: list[str] | None) -> Any:  # noqa: ANN401
    """Simulate the rig while its load steps from a half to the whole; return the data."""
    whole = _full_torque(changes)
    half, full = f"{whole / 2:.12g} N*m", f"{whole:.12g} N*m"
    rows = [["0 s", half], [f"{STEP} s", half], [f"{STEP + 1e-3} s", full], [f"{STEP_END} s", full]]
    step = f"loads.generator={{ member = 'generator', torque_over_time = {rows} }}"
    return _simulate(RIGS["assumed"], [*(changes or []), step], STEP_END).dataset


def _shares(scene: str) -> list[float]:
    """Return each planet's mean force at the sun over that of all."""
    from ..analysis.sharing import list_groups

    result = _simulate(scene, None, 1.0)
    means = [abs(result.summary["forces"][mesh]["mean"]) for mesh in list_groups(result.dataset)[SUN_MESHES]]
    return [mean * len(means) / sum(means) for mean in means]


def _simulate(scene: str, changes: list[str] | None, t_end: float) -> "Result":
    """Simulate a scene in memory."""
    from ..simulation.simulate import simulate

    opened = open_scene(scene, changes)
    result = simulate(
        compile_model(opened), opened.model.values(), t_end=t_end, rate=opened.scene.simulation.rate,
        tables=opened.model.tables,
    )  # fmt: skip
    running.finished(result.summary)
    return result
