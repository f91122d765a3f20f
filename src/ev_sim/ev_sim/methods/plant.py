"""Registers the plants."""

import ev_sim.plant.kinematic  # noqa: F401
