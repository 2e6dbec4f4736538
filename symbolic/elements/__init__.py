"""Elements: energy and hand-written forces of meshes, bearings, couplings and loads, in SymPy."""
