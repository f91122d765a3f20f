"""Registers the drivers."""

import ev_sim.driver.manoeuvre
import ev_sim.driver.path_follower
import ev_sim.driver.speed_profile  # noqa: F401
