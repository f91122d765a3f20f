"""Tuning of the laws of a board: free numbers, training runs, one search for all (docs/benchmark.md)."""
