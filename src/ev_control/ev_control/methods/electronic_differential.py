"""Registers the electronic differentials."""

from ev_control.electronic_differential import (  # noqa: F401
    direct_yaw_moment,
    mechanical,
    neutral_steering,
    rear_targets,
    steering_by_drives,
    torque_shares,
)
