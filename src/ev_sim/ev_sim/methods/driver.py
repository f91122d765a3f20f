"""Registers the drivers."""

import ev_sim.driver.manoeuvre
import ev_sim.driver.path_follower
import ev_sim.driver.preview.preview
import ev_sim.driver.speed_profile
import ev_sim.driver.urban_drivers  # noqa: F401
