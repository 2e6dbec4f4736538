"""Torture: seeded attacks on ltcgear by scenes, files, kills, full disks, compilers and environments.

``python -m tests.torture`` (``make torture``) runs all, tests/test_torture.py a few of each kind.
"""
