"""Registers the electronic differentials."""

from ev_control.electronic_differential import (  # noqa: F401
    adaptive,
    course_stability,
    mechanical,
    neutral_steering,
    slip_target,
    steering_by_drives,
    steering_correction,
    torque_shares,
    wheel_speed,
)
