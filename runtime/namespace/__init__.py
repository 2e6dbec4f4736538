"""ltcgear: dynamics of gearboxes, from a scene to mesh forces, eigenfrequencies and reports.

>>> import ltcgear as lg
>>> gear = lg.load("lsp")
"""

import lazy_loader

_find, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name: str) -> object:
    """Load a public name, or the version, when it is first asked for."""
    if name == "__version__":
        from importlib.metadata import version

        return version("ltcgear")
    return _find(name)
