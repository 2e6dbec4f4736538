"""Python interface: a gearbox in one object, from the scene to its results."""
