"""Figures, tables and pages of what was computed."""
