"""Equation book: the equations of a scene, typeset from the symbols of which its C is made."""
