"""Scenarios: parameter files resolved to configured graphs, and the ways to run them."""
