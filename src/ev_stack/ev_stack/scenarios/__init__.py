"""Scenarios: parameter files resolved to configured graphs."""
