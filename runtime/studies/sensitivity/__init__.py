"""Sensitivities of eigenfrequencies and of outputs of a simulation to all parameters."""
