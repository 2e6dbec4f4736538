"""Symbolic side: from scenes to equations of motion (SymPy), and from these to C (CasADi).

Public names load their modules on first use: reading a scene imports neither SymPy nor CasADi.
"""

from importlib import import_module
from typing import Any

_HOME = {
    "SceneBuilder": "scene.builder",
    "describe_scene": "scene.load",
    "load_scene": "scene.load",
    "make_scene": "scene.load",
    "read_source": "scene.load",
    "restore_scene": "scene.load",
    "shipped_scenes": "scene.load",
    "Template": "emit.template",
    "build_model": "assembly",
    "derive": "mechanics.equations",
    "generate": "emit.pipeline",
    "steer_loads": "scene.steering",
    "check_model": "checks.all_checks",
    "check_paper": "checks.paper",
}
__all__ = list(_HOME)


def __getattr__(name: str) -> Any:  # noqa: ANN401
    """Load a public name from its module."""
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f".{_HOME[name]}", __name__), name)
