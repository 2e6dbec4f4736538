"""The equation book of a scene: its chapters in order, and its file."""

from collections.abc import Callable, Sequence
from importlib.metadata import version
from pathlib import Path
from typing import Any

from ltcgear.generated.contract import Manifest
from ltcgear.generated.errors import LtcgearError
from ltcgear.generated.writing import check_output, write_text

from ..checks.check import Check
from ..describe.variants import acting_effects
from ..mechanics.model import Model
from ..schema.scene_schema import Scene
from .chapter_balances import write_balances
from .chapter_checks import KINDS, write_checks, write_identity, write_paper
from .chapter_elements import write_elements, write_meshes
from .chapter_laws import write_laws
from .chapter_motion import write_motion
from .chapter_scene import write_scene
from .content import Book, Chapter
from .pages import require_packages, write_html, write_latex
from .paper_rows import print_rows

WRITERS: dict[str, Callable[[Book], str]] = {".html": write_html, ".tex": write_latex}


def make_book(scene: Scene, model: Model, manifest: Manifest, key: str, checks: Sequence[Check]) -> Book:
    """Assemble the equation book of a scene.

    Parameters
    ----------
    scene, model
        A scene and its model.
    manifest, key
        Manifest of its C, and the key of the C in the store.
    checks
        Results of the model's checks.
    """
    rows, identity, effects = print_rows(), identify(manifest, key), acting_effects(scene, model)
    writers: tuple[tuple[str, str, Callable[[Chapter], None]], ...] = (
        ("The scene", "scene", lambda c: write_scene(c, scene, model, effects)),
        ("Coordinates and frames", "motion", lambda c: write_motion(c, model)),
        ("Energies and force laws", "laws", lambda c: write_laws(c, model)),
        ("Elements", "elements", lambda c: write_elements(c, model)),
        ("Mesh phase, stiffness and loads over time", "meshes", lambda c: write_meshes(c, model)),
        ("Equations of motion", "balances", lambda c: write_balances(c, model)),
        ("Checks", "checks", lambda c: write_checks(c, checks)),
        ("The paper's printed equations", "paper", lambda c: write_paper(c, rows)),
        ("What this book belongs to", "identity", lambda c: write_identity(c, identity)),
    )
    chapters = []
    for number, (title, anchor, write) in enumerate(writers, start=1):
        chapters.append(Chapter(number, title, anchor))
        write(chapters[-1])
    acting = {str(row["effect"]): str(row["value"]) for row in effects}
    passed = sum(check.passed for check in checks)
    verdicts = [row.verdict.verdict for row in rows]
    return Book(
        scene.title, scene.name, acting, tuple(chapters), identity,
        {"passed": passed, "failed": len(checks) - passed}, {kind: verdicts.count(kind) for kind in KINDS},
    )  # fmt: skip


def identify(manifest: Manifest, key: str) -> dict[str, str]:
    """Return what identifies the C of a book."""
    told = {"key": key, "digest of the C": manifest.key, "ltcgear": version("ltcgear"), "SymPy": version("sympy")}
    told |= {"CasADi": manifest.casadi, "states": str(len(manifest.states))}
    told |= {"parameters": str(len(manifest.parameters))}
    return told | {f"operations of {name}": str(item.operations) for name, item in manifest.functions.items()}


def check_file(path: Path, *sources: str) -> None:
    """Refuse a file that is neither HTML nor LaTeX, and any file if the packages for pages are missing.

    Raises
    ------
    LtcgearError
        If the suffix is neither .html nor .tex, or if a package is missing.
    """
    require_packages()
    check_output(path, *sources)
    if path.suffix not in WRITERS:
        raise LtcgearError(f"{path}: a book is written as .html or .tex; name it {path.with_suffix('.html')}")


def write_book(book: Book, path: Path) -> None:
    """Write a book to a file, as HTML or LaTeX by its suffix; it is written completely or not at all.

    Raises
    ------
    LtcgearError
        If the suffix is wrong, a package for pages is missing, or the file cannot be written.
    """
    check_file(path)
    write_text(WRITERS[path.suffix](book), path)


def list_content(book: Book) -> dict[str, Any]:
    """Return the contents of a book for JSON."""
    return {
        "scene": book.scene,
        "title": book.title,
        "key": book.identity["key"],
        "chapters": [
            {
                "title": chapter.title,
                "anchor": chapter.anchor,
                "equations": len(chapter.equations),
                "sections": [heading.title for heading in chapter.headings],
            }
            for chapter in book.chapters
        ],
        "equations": sum(len(chapter.equations) for chapter in book.chapters),
        "checks": book.checks,
        "paper": book.paper,
    }
