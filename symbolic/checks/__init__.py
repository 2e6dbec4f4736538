"""Checks: derivations compared with one another, with print and with known numbers."""
