"""Steered rear wheels: a law for their angle, and the motor that turns them (docs/rear_steering.md)."""
