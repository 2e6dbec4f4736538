"""Integration in time: from the equilibrium to a result, in memory or on disk."""
