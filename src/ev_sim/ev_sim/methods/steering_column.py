"""Registers the steering columns."""

import ev_sim.steering_column.actuated
import ev_sim.steering_column.by_wire
import ev_sim.steering_column.manual
import ev_sim.steering_column.powered
import ev_sim.steering_column.steering_robot  # noqa: F401
