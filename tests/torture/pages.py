"""Commands of pages: what README.md and docs/*.md show in blocks, in the order in which a reader meets it."""

import os
import re
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
FENCE = re.compile(r"^```(\w+)\n(.*?)^```$", re.DOTALL | re.MULTILINE)
IMPORTS = re.compile(r"^(import|from) ", re.MULTILINE)
SHELL, CONSOLE, PYTHON, SCENE = "sh", "console", "python", "toml"
PINS = " ".join((
    "ltcgear sweep lsp -o pins.nc --sample normal --points 1000 --t-end 0.75 --set effects.planet_position_error=on",
    "--set 'stages.lsp.position_errors=[{planet=1}, {planet=2}, {planet=3}, {planet=4}]'",
    *(f"--vary 'stages.lsp.position_errors.{i}.tangential=0 um:20 um'" for i in range(4)),
))  # fmt: skip
NOT_RUN = {
    "make rig": "installs what the tests run in; what it prints is tested by tests/test_paper.py",
    "make test": "is what runs the tests",
    "make torture": "is what runs this",
    PINS: "1000 runs, some minutes; tests/runtime/studies/test_sweep_sharing.py has fewer",
    "dask scheduler": "needs machines; tests/runtime/studies/test_sweep_cluster.py sweeps over a scheduler of its own",
    "dask worker tcp://10.0.0.5:8786 --nthreads 1": "likewise",
    "ltcgear sweep lsp --vary 'loads.ring.speed=5 rpm:20 rpm:64' --scheduler tcp://10.0.0.5:8786 -o speeds.nc": "again",
}
"""Commands that no test can run as they stand, and why."""


@dataclass(frozen=True)
class Step:
    """A command, a program or a scene of a page.

    ``text`` is what is run; ``said`` what the page says that it prints on standard error.
    """

    page: str
    number: int
    kind: str
    text: str
    said: str | None = None

    @property
    def head(self) -> str:
        """The command without its comment; of programs and scenes the place on the page."""
        if self.kind in (SHELL, CONSOLE):
            return " ".join(re.sub(r"\s+#\s.*", "", self.text).split())
        return f"{self.page} {self.kind} {self.number}"


def pages() -> list[str]:
    """Return the pages."""
    return ["README.md", *(f"docs/{path.name}" for path in sorted((ROOT / "docs").glob("*.md")))]


def read_steps(page: str) -> list[Step]:
    """Return what a page shows to be run, in its order."""
    return [Step(page, number, *step) for number, step in enumerate(_steps((ROOT / page).read_text("utf-8")), start=1)]


def _steps(text: str) -> Iterator[tuple[str, str, str | None]]:
    """Yield kind, text and what is said of every step."""
    shown = ""
    for found in FENCE.finditer(text):
        kind, block = found.groups()
        if kind == SHELL:
            for line in block.replace("\\\n", " ").splitlines():
                if line.strip() and not line.startswith("#"):
                    yield kind, line, None
        elif kind == CONSOLE:
            for part in re.split(r"^\$ ", block, flags=re.MULTILINE)[1:]:
                line, _, said = part.partition("\n")
                yield kind, line, said
        elif kind == PYTHON:  # one without imports goes on with those before it
            shown = block if IMPORTS.search(block) and not _goes_on(block) else shown + block
            yield kind, shown, None
        elif kind == SCENE:
            name = re.search(r"`([\w-]+\.toml)`|([\w-]+\.toml)", text[found.end() :])
            yield kind, f"{(name[1] or name[2]) if name else 'scene.toml'}\n{block}", None


def _goes_on(block: str) -> bool:
    """Say whether a program takes up names of the one before it: it imports, but builds or loads nothing."""
    return "ltcgear" not in block and "fmpy" not in block


def run_step(step: Step, folder: Path, seconds: float = 600.0) -> str:
    """Run a step where the ones before it ran; return what is wrong about it, "" where nothing is."""
    here = folder / ".here"
    now = Path(here.read_text("utf-8").strip()) if here.exists() else folder
    if step.kind == SCENE:
        name, _, scene = step.text.partition("\n")
        (now / name).write_text(scene, "utf-8")
        return ""
    if not (folder / ".venv").exists():
        (folder / ".venv").symlink_to(sys.prefix)  # what `. .venv/bin/activate` finds in a clone
    command = [sys.executable, "-c", step.text]
    if step.kind != PYTHON:
        command = ["bash", "-ec", f"{step.text}\npwd > {here}"]
    settings = os.environ | {"PATH": f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"}
    try:
        done = subprocess.run(
            command, cwd=now, capture_output=True, text=True, check=False, timeout=seconds, env=settings,
            stdin=subprocess.DEVNULL,
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        return f"no end after {seconds:g} s"
    if step.said is not None:
        return "" if done.stderr == step.said else f"prints {done.stderr!r}"
    return "" if done.returncode == 0 else f"exit code {done.returncode}: {done.stderr[-1500:]}"
