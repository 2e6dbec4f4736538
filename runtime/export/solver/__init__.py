"""Right-hand side and Jacobian for a solver of one's own."""
