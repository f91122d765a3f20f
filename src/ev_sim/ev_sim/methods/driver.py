"""Registers the drivers."""

import ev_sim.driver.speed_profile  # noqa: F401
