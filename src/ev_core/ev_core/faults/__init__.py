"""Faults of a run, declared as texts with times, deterministic by seed (docs/faults.md)."""
