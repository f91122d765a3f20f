"""Registers the drivers."""

import ev_sim.driver.imposed_speed
import ev_sim.driver.manoeuvre
import ev_sim.driver.path_follower
import ev_sim.driver.preview.preview
import ev_sim.driver.pulse
import ev_sim.driver.speed_profile
import ev_sim.driver.tracking  # noqa: F401
