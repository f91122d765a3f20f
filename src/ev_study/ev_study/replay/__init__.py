"""Recorded inputs into a law or a node, and its answers beside the recorded ones (docs/replay.md)."""
