"""Analysis of a result: spectra, orders, loads and orbits, as functions of outputs over time."""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
