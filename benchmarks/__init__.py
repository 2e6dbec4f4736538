"""Benchmarks: what effects and methods cost, written into docs/ by scripts."""
