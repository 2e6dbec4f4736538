"""Accuracy against time: errors, counts and times of every method and tolerance, against a reference."""
