"""Registers the steering columns."""

import ev_sim.steering.active_front
import ev_sim.steering.actuated
import ev_sim.steering.by_wire
import ev_sim.steering.driven_by_hand
import ev_sim.steering.steering_robot  # noqa: F401
