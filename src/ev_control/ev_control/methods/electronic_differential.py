"""Registers the electronic differentials."""

import ev_control.electronic_differential.drive_by_wire
import ev_control.electronic_differential.equal_torque
import ev_control.electronic_differential.power_steering
import ev_control.electronic_differential.steer_by_wire  # noqa: F401
