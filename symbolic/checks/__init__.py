"""Checks: derivations compared with one another, with the printed paper and with known numbers."""
