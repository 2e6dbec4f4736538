"""Compiled models at work: equilibrium, integration, linearisation, results."""
