"""Scenes: read from TOML or made in Python, validated, changed."""
