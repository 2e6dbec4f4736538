"""Symbolic side: from scenes to equations of motion (SymPy), and from these to C (CasADi).

Public names load their modules on first use: reading a scene imports neither SymPy nor CasADi.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
