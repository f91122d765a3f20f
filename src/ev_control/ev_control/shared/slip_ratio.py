"""Slip ratio of a wheel from its speed and that of the ground beneath it."""

from __future__ import annotations

from ev_msgs_py.compiling.compilable import compilable


@compilable
def slip_ratio(wheel_speed: float, ground_speed: float, slowest: float) -> float:
    """Slip ratio [1], positive in traction: (w R - V)/(w R) driving, (w R - V)/V braking (Ge & Ni 2005).

    `wheel_speed` is w R and `ground_speed` the velocity V of the wheel's centre along the wheel [m/s]; the divisor is
    the larger of both magnitudes, and at least `slowest` [m/s], above zero, so that a car at rest has no slip.
    """
    return (wheel_speed - ground_speed) / max(abs(wheel_speed), abs(ground_speed), slowest)
