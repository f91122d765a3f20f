"""The car as viewers show it: its geometry, its description as URDF, and what moves of it as messages."""
