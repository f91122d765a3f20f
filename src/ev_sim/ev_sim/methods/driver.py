"""Registers the drivers."""

from ev_sim.driver import followers, lap_driver, pedals, preview_driver, urban_drivers  # noqa: F401
