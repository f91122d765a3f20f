"""Functional Mock-up Units of a car or a law, for the tools of others (docs/embedding.md)."""
