"""Registers the steering columns."""

from ev_sim.steering import active_front, actuated, column, steering_robot  # noqa: F401
