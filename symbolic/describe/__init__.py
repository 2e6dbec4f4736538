"""Descriptions: what a scene amounts to in numbers and words."""
