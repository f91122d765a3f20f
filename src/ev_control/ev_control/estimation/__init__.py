"""Quantities that laws have to estimate because no sensor of a car measures them."""
