"""Scenes to equations to C text (SymPy; CasADi only where expressions are lowered).

Public names load their modules on first use, so that reading a scene needs neither SymPy nor CasADi.
"""

from importlib import import_module
from typing import Any

_HOME = {
    "SceneBuilder": "builder",
    "describe_scene": "scene",
    "load_scene": "scene",
    "make_scene": "scene",
    "read_source": "scene",
    "restore_scene": "scene",
    "shipped_scenes": "scene",
    "Template": "template",
    "build_model": "build",
    "derive": "equations",
    "generate": "pipeline",
    "steer_loads": "steering",
    "check_model": "checks.run",
    "check_paper": "checks.paper",
}
__all__ = list(_HOME)


def __getattr__(name: str) -> Any:  # noqa: ANN401
    """Load a public name from its module."""
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f".{_HOME[name]}", __name__), name)
