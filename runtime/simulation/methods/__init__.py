"""Integrators: each follows one segment of smooth motion."""
