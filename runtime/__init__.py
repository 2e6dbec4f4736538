"""Runtime: compiled models at work, from the equilibrium to results and reports."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
