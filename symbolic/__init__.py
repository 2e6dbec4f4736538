"""Scenes to equations to C text (SymPy; CasADi only where expressions are lowered)."""
