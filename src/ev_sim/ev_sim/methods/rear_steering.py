"""Registers the laws of the rear wheels' angle."""

import ev_sim.rear_steering.speed_dependent
import ev_sim.rear_steering.zero_sideslip  # noqa: F401
