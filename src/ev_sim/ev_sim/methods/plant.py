"""Registers the plants."""

import ev_sim.plant.kinematic
import ev_sim.plant.planar.on_bench
import ev_sim.plant.planar.planar  # noqa: F401
