"""Energy levels that distinguish a loaded train from an unloaded one."""

LOADED = 1e-9
"""Strain energy [J] from which a train counts as loaded."""
UNLOADED = 1e-6
"""Energy per degree of freedom [J] that replaces the strain energy of an unloaded train."""
