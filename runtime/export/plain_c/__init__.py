"""A scene as plain C: numbers and names (data), and the integration that goes with them (kit)."""
