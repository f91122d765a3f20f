"""Many runs of one graph with other parameters, seeds or initial states as one call (docs/batch.md)."""
