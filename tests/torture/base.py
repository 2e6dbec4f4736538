"""What all attacks start from: everything imported, every shipped scene in the store, compiled."""

from functools import partial
from pathlib import Path

from .process import Program

FEW = ("psh", "lsp")
"""Scenes that every attack needs."""


def _compile(few: bool) -> int:
    """Put shipped scenes and what simulates them into the store."""
    from ltcgear.runtime.model.building import build
    from ltcgear.runtime.model.cstruct import engine
    from ltcgear.symbolic import build_model, load_scene
    from ltcgear.symbolic.emit.pipeline import obtain
    from ltcgear.symbolic.scene.load import shipped_scenes

    engine()
    for name in FEW if few else shipped_scenes():
        build(obtain(build_model(load_scene(name))))
    return 0


def prepare(few: bool = False) -> None:
    """Import everything; fill the store in a process of its own, so that this one knows no compiler yet."""
    import xarray  # noqa: F401

    done = Program(partial(_compile, few), Path.cwd()).wait(600)
    if done.code != 0:
        raise SystemExit(f"the store could not be filled: {done.err}")
