"""Contract between the symbolic side and the runtime, the store, and committed C."""
