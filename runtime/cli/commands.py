"""Commands: all of the command line, put together."""

import os

# The matrices are small: threads of the linear algebra would only wait for each other (seen: 100 ms in place of 1).
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
# Figures are files: a backend that the surroundings name (Jupyter does) is not needed, and may not be there.
os.environ["MPLBACKEND"] = "agg"

from . import (
    analysing,
    book_command,
    describe,
    exporting,
    influences,
    linear,
    measuring,
    reporting,
    reproducing,
    resonance_commands,
    results,
    running,
    stability,
    sweeping,
    testing,
)
from .app import app, main

__all__ = [
    "analysing",
    "app",
    "book_command",
    "describe",
    "exporting",
    "influences",
    "linear",
    "main",
    "measuring",
    "reporting",
    "reproducing",
    "resonance_commands",
    "results",
    "running",
    "stability",
    "sweeping",
    "testing",
]
