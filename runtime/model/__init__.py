"""The compiled model: parameters, load tables, contact levels, and the loaded equilibrium at which it runs."""
