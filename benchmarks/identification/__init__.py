"""Identification: numbers of a scene that nobody printed, from what its simulation is known to show."""
