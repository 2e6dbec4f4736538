"""What all attacks start from: everything imported, every shipped scene in the store, compiled."""

from pathlib import Path

from .process import Program

SCENES = ("psh", "lsp")


def _compile() -> int:
    """Put all shipped scenes and what simulates them into the store."""
    from ltcgear.runtime.library import build
    from ltcgear.runtime.native import engine
    from ltcgear.symbolic import build_model, load_scene
    from ltcgear.symbolic.pipeline import obtain
    from ltcgear.symbolic.scene import shipped_scenes

    engine()
    for name in shipped_scenes():
        build(obtain(build_model(load_scene(name))))
    return 0


def prepare() -> None:
    """Import everything; fill the store in a process of its own, so that this one knows no compiler yet."""
    import xarray  # noqa: F401

    done = Program(_compile, Path.cwd()).wait(600)
    if done.code != 0:
        raise SystemExit(f"the store could not be filled: {done.err}")
