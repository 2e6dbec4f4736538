"""Sweeps: many runs of one model, their metrics, and what these say."""
