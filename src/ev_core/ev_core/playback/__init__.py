"""Roles that are played by what was recorded: `method: .../signals.npz`."""
