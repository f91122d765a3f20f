"""Faults of the car in the planar plant (docs/faults.md)."""
