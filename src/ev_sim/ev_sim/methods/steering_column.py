"""Registers the steering columns."""

from ev_sim.steering import actuated, column, imposed, steering_robot  # noqa: F401
