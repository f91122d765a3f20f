"""Importing this module registers every plant, steering column and driver of ev_sim."""

import ev_sim.driver.speed_profile
import ev_sim.plant.kinematic
import ev_sim.plant.planar.plant
import ev_sim.steering_column.by_wire
import ev_sim.steering_column.manual
import ev_sim.steering_column.powered  # noqa: F401
