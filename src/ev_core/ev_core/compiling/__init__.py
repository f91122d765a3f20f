"""Compiled code, from the same text that Python runs (docs/compiled_laws.md)."""
