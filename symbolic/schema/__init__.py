"""The scene's schema: strict tables, quantities with units, the table of effects."""
