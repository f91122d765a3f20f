"""Comparisons with measured data and results of others, each with its limit and its driving."""
