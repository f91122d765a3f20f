"""Tyres: friction curves over slip, combined slip, and the carcass between rim and contact."""
