"""Registers the plants."""

import ev_sim.plant.kinematic
import ev_sim.plant.planar  # noqa: F401
