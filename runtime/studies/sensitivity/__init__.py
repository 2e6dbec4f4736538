"""Sensitivities: what to change to move an eigenfrequency or an output of a simulation, and by how much."""
