"""The contract between the symbolic and the running side, and the C that was emitted."""
