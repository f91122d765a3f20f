"""Registers the steering columns."""

from ev_sim.steering import actuated, column, steering_robot  # noqa: F401
