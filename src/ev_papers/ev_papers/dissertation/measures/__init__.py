"""Measures of the dissertation's urban cycle: circuits, windows, efficiencies and slip curves."""
