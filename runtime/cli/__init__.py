"""The command line, the one place that knows all three parts: scene -> model -> C -> results."""
