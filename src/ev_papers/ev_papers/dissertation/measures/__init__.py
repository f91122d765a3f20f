"""Measures of the urban cycle: circuits, windows, efficiencies and slip curves."""
