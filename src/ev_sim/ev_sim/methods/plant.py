"""Registers the plants."""

import ev_sim.plant.kinematic.plant
import ev_sim.plant.planar.on_bench
import ev_sim.plant.planar.plant
import ev_sim.plant.planar.rear_steering
import ev_sim.plant.planar.speed_mode  # noqa: F401
