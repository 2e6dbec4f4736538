"""Energy levels that tell a loaded train from an unloaded one."""

LOADED = 1e-9
"""Strain energy [J] from which a train counts as loaded."""
UNLOADED = 1e-6
"""Energy of a degree of freedom [J] that stands for the strain energy of a train that is not loaded."""
