"""Registers the plants."""

import ev_sim.plant.kinematic
import ev_sim.plant.planar.plant  # noqa: F401
