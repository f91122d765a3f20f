"""Registers the laws of the rear wheels' angle."""

import ev_sim.steering.rear_axle  # noqa: F401
