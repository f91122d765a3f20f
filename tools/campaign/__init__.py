"""A campaign of faults: whatever happens to a run, it ends with the right result, or safely and by name."""
