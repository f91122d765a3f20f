"""Traction batteries."""
