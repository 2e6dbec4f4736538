"""Command accuracy: what accuracy costs in time, and the choice of settings by it."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from ltcgear.generated.errors import LtcgearError, SolverError
from ltcgear.generated.writing import make_folder

from ..results.terminal import tell
from ..view.tables import printed
from .app import app
from .opening import Opened, compile_model, open_scene, rate_of
from .options import AsJson, Changes, Force, SceneName
from .progress import progress
from .testing import MethodNames, choose

if TYPE_CHECKING:
    from ..model.library import Library
    from ..studies.accuracy.selection import Setting

PresetName = Annotated[
    str, typer.Option("--preset", metavar="NAME", help="quick (some tolerances, under a minute) or full.")
]
StudyEnd = Annotated[
    float | None,
    typer.Option("--t-end", help="Time to simulate [s].", show_default="some pitches of the slowest mesh"),
]
Tolerances = Annotated[
    list[float] | None,
    typer.Option("--rtol", metavar="RTOL", help="A tolerance to run.", show_default="the preset's"),
]
RecordFolder = Annotated[
    Path | None,
    typer.Option("-o", "--output", help="Folder for accuracy.json, accuracy.csv and figures.", show_default="none"),
]


@app.command()
def accuracy(
    scene: SceneName, output: RecordFolder = None, preset: PresetName = "quick", t_end: StudyEnd = None,
    method: MethodNames = None, rtol: Tolerances = None, changes: Changes = None,
    force: Force = False, as_json: AsJson = False,
) -> None:  # fmt: skip
    """Measure which accuracy every method gives for its time. Exit code 3 where there is no reference to judge by."""
    from ..simulation.methods.registry import METHODS, find_method
    from ..simulation.run_settings import check_options
    from ..studies.accuracy.phases import measure_phases
    from ..studies.accuracy.presets import check_preset
    from ..studies.accuracy.record import keep, write_record
    from ..studies.accuracy.study import phases_setting
    from ..view.tables.accuracy_tables import make_tables

    check_preset(preset)
    methods = choose(method, list(METHODS), "method") if method else None
    for name in methods or []:
        find_method(name)
    for tolerance in rtol or [1e-6]:
        check_options("erk", tolerance, t_end)
    if output is not None:
        make_folder(output)
    opened = open_scene(scene, changes)
    record = measure(opened, compile_model(opened), preset, t_end=t_end, methods=methods, rtols=rtol)
    arguments = [scene, *(part for change in changes or [] for part in ("--set", change))]
    record["phases"] = measure_phases(arguments, record["t_end"], *phases_setting(record))
    if not methods and not rtol and record["reference"]["reason"] is None:
        keep(record)
    files = []
    if output is not None:
        from ..view.figures.accuracy_figures import draw_all

        files = [*write_record(record, output), *draw_all(record, output)]
    printed.show(as_json, record, lambda shown: printed.listed(make_tables(shown), files))
    if record["reference"]["reason"] is not None:
        raise SolverError(f"{scene}: no reference for errors: {record['reference']['reason']}")


def measure(opened: Opened, library: "Library", preset: str, **wanted: Any) -> dict[str, Any]:  # noqa: ANN401
    """Measure a scene that is built; ``wanted`` are times, methods and tolerances that are not the preset's."""
    from ..studies.accuracy.presets import check_preset
    from ..studies.accuracy.study import Wanted, run_study
    from ..studies.selftest.case import Bench

    model = opened.model
    bench = Bench(library, model.values(), model.tables)
    study = Wanted(
        opened.scene.name, opened.scene.title, *_keys(opened), rate_of(opened, library),
        opened.scene.simulation.t_end, preset, check_preset(preset), **wanted,
    )  # fmt: skip
    with progress(f"measure {opened.scene.name}", 100, "%") as told:
        return run_study(bench, study, lambda done: told(100 * done))


def _keys(opened: Opened) -> tuple[str, str]:
    """Return the keys of a model and of its numbers."""
    from ..studies.accuracy.record import digest_numbers

    return opened.key, digest_numbers(opened.scene.model_dump_json(exclude_none=True))


def check_accuracy(asked: str | None, path: Path | None, given: list[str]) -> None:
    """Refuse an accuracy, or a record, that cannot be served, before anything is computed.

    ``given`` are options that say what the accuracy would choose.
    """
    if asked is None:
        if path is not None:
            raise LtcgearError(f"--record {path}: say which error is wanted, for example --accuracy 0.1%")
        return
    from ..studies.accuracy.record import read_record
    from ..studies.accuracy.selection import read_percentage

    read_percentage(asked)
    if given:
        raise LtcgearError(f"--accuracy chooses method and tolerance; leave out {' and '.join(given)}")
    if path is not None:
        read_record(path)


def find_setting(opened: Opened, library: "Library", asked: str, path: Path | None) -> "Setting":
    """Find method and tolerance for an accuracy: from the record given, the store's, or one that is made now.

    One that is made now is kept, so that the wait comes once for a model with its numbers.
    """
    from ..studies.accuracy.record import keep, kept_path, read_record
    from ..studies.accuracy.selection import read_percentage, select_setting

    keys = _keys(opened)
    limit, source = read_percentage(asked), path or kept_path(*keys)
    if path is None and not source.is_file():
        name = opened.scene.name
        tell(f"{name}: no record of its accuracy yet; measuring one (preset quick)")
        record = measure(opened, library, "quick")
        if record["reference"]["reason"] is not None:
            raise SolverError(f"{name}: no accuracy can be told: {record['reference']['reason']}")
        keep(record)
    setting = select_setting(read_record(source), source, limit, *keys)
    if setting.warning:
        tell(f"warning: {setting.warning}")
    return setting
