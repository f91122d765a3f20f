"""Studies: many runs of scenarios, driven side by side by worker processes, and one table of all."""
