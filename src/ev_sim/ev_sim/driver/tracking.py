"""A driver who follows the cycle."""

from __future__ import annotations

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.contract.signals import WheelStates
from ev_msgs_py.vehicle.car import Car
from ev_sim.driver.cycle_driver import CycleDriverParameters, CycleDriverState, cycle_driver
from ev_sim.driver.speed_control import follow_speed


@cycle_driver("tracking", CycleDriverParameters)
@compilable
def tracking(
    p: CycleDriverParameters,
    car: Car,
    s: CycleDriverState,
    period: float,
    wanted: float,
    speed: float,
    wheels: WheelStates,
) -> float:
    """Follow a speed cycle with just the drive torque that it takes, and keep the lane.

    In windows of traction the foot is on the accelerator or off, never on the brake. This driver never asks for more
    than packed snow carries, so all torque controls come out alike (docs/dissertation.md).
    """
    s.speed_control.integral = max(s.speed_control.integral, 0.0)
    drive, _ = follow_speed(p.speed_control, car, s.speed_control, period, wanted, speed)
    return max(drive, 0.0)
