"""Schema of a scene: strict tables, quantities with units, the table of effects."""
