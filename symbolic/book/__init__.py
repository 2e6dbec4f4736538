"""Equation book: the equations of a scene, typeset from the symbols of its C."""
