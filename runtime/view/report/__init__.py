"""Report of a result: one HTML page with an animated stage view, figures and tables."""
