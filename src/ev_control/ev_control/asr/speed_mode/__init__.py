"""Traction controls that set each wheel a speed, for drives in speed mode."""
