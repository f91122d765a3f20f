"""Registers the drivers."""

from ev_sim.driver import followers, pedals, preview_driver, urban_drivers  # noqa: F401
