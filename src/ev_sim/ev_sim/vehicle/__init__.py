"""What the linear single-track model takes from a vehicle: below driver, plant and report."""
