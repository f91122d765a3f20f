"""Registers the drivers."""

from ev_sim.driver import path_follower, pedals, preview_driver, profile_driver, urban_drivers  # noqa: F401
