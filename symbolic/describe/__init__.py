"""Descriptions of a scene in numbers and words."""
