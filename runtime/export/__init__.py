"""The model for other programs: FMUs, plain C, functions for one's own solver."""
