"""Growth: what planets and stages cost (``python -m benchmarks.growth``)."""
