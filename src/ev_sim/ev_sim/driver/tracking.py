"""A driver who follows the cycle."""

from __future__ import annotations

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.contract.signals import BodyPose, BodyVelocity, DriverCommand, Instant, SteeringColumnState, WheelStates
from ev_msgs_py.lockstep.methods import method
from ev_msgs_py.vehicle.car import Car
from ev_sim.driver.cycle_driver import Cycle, CycleDriverParameters, CycleDriverState, cycle_of, drive_cycle
from ev_sim.driver.speed_control import follow_speed
from ev_sim.profiles.profile_file import with_speed_profile_from_file


@compilable
def needed_torque(
    p: CycleDriverParameters,
    car: Car,
    s: CycleDriverState,
    period: float,
    wanted: float,
    speed: float,
    wheels: WheelStates,
) -> float:
    """What the speed control asks for, as far as it drives [N m]."""
    integral = max(s.speed_integral, 0.0)
    drive, _, s.speed_integral = follow_speed(p.speed_control, period, wanted, speed, integral)
    return max(drive, 0.0)


@method(
    "driver",
    "tracking",
    CycleDriverParameters,
    state=CycleDriverState,
    prepare=cycle_of,
    load_files=with_speed_profile_from_file,
    mirrored=True,
)
@compilable
def tracking(
    p: CycleDriverParameters,
    car: Car,
    c: Cycle,
    s: CycleDriverState,
    period: float,
    now: Instant,
    body: BodyVelocity,
    pose: BodyPose,
    column: SteeringColumnState,
    wheels: WheelStates,
) -> DriverCommand:
    """Follow a speed cycle with just the drive torque that it takes, and keep the lane.

    In windows of traction the foot is on the accelerator or off, never on the brake. This driver never asks for more
    than packed snow carries, so all torque controls come out alike (docs/dissertation.md).
    """
    return drive_cycle(needed_torque, p, car, c, s, period, now, body, pose, column, wheels)
