"""Mechanics: a model's coordinates, kinematics and equations of motion."""
