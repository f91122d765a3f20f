"""Laws, drivers, columns and plants as compiled code, from the same text that Python runs (docs/compiled_laws.md)."""
