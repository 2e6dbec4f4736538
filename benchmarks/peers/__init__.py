"""Peers: the same physics by other tools, checked against ours, then timed beside it."""
