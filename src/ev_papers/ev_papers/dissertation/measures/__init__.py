"""What is measured of the dissertation's urban cycle: its circuits, windows, efficiencies and slip curves."""
