"""The car for viewers: its geometry, its description as URDF, and its motion as messages."""
