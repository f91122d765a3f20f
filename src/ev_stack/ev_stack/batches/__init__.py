"""Many runs of one graph in one call (docs/batch.md)."""
