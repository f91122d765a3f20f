"""Registers the plants."""

import ev_sim.plant.kinematic.plant
import ev_sim.plant.planar.on_bench
import ev_sim.plant.planar.plant
import ev_sim.plant.planar.variants  # noqa: F401
