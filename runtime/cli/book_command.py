"""Command book: the equation book of a scene."""

import typer

from ..view.tables import printed
from ..view.tables.scene_tables import list_book
from .app import app
from .opening import open_scene
from .options import AsJson, BookFile, Changes, Force, SceneName


@app.command()
def book(
    scene: SceneName, output: BookFile, changes: Changes = None, force: Force = False, as_json: AsJson = False
) -> None:
    """Write the equation book: coordinates, energies, laws, equations of motion, checks, the paper's equations.

    It is typeset from the symbols that the C is made of. Exit code 1 if a check fails.
    """
    from ltcgear.symbolic.book.volume import check_file, list_content, make_book, write_book
    from ltcgear.symbolic.checks.all_checks import check_model

    check_file(output, scene)
    opened = open_scene(scene, changes, output)
    checks = check_model(opened.model)
    made = make_book(opened.scene, opened.model, opened.artifact.manifest, opened.key, checks)
    write_book(made, output)
    data = list_content(made) | {"file": str(output), "bytes": output.stat().st_size}
    printed.show_tables(as_json, data, list_book)
    if made.checks["failed"]:
        raise typer.Exit(1)
