"""Gears: geometry, mesh stiffness, rigid-body motion and statics of a train."""
