"""The command line, the one place that knows all three parts: scene -> model -> C -> results."""

from . import describe, measuring, running, testing
from .app import app, main

__all__ = ["app", "describe", "main", "measuring", "running", "testing"]
