"""A driver who asks for a power while the cycle imposes the speed."""

from __future__ import annotations

from dataclasses import dataclass

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.contract.signals import BodyPose, BodyVelocity, DriverCommand, Instant, SteeringColumnState, WheelStates
from ev_msgs_py.lockstep.methods import method
from ev_msgs_py.parameters.declaration import group
from ev_msgs_py.vehicle.car import Car
from ev_msgs_py.vehicle.layout import any_driven
from ev_sim.driver.cycle_driver import Cycle, CycleDriverParameters, CycleDriverState, cycle_of, drive_cycle
from ev_sim.driver.power_level import PowerLevelParameters, torque_of_power
from ev_sim.profiles.profile_file import with_speed_profile_from_file


@dataclass(frozen=True, slots=True)
class ImposedSpeedParameters(CycleDriverParameters):
    """The cycle and the power."""

    level: PowerLevelParameters = group(PowerLevelParameters)


@compilable
def torque_of_level(
    p: ImposedSpeedParameters,
    car: Car,
    s: CycleDriverState,
    period: float,
    wanted: float,
    speed: float,
    wheels: WheelStates,
) -> float:
    """The power, whatever the speed that is wanted [N m]."""
    return torque_of_power(p.level, car, speed, wheels)


@method(
    "driver",
    "imposed_speed",
    ImposedSpeedParameters,
    state=CycleDriverState,
    prepare=cycle_of,
    load_files=with_speed_profile_from_file,
    needs=(any_driven,),
    mirrored=True,
)
@compilable
def imposed_speed(
    p: ImposedSpeedParameters,
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
    """Ask for a power above the limit of packed snow in all windows of traction, whatever the speed.

    For a plant whose speed the cycle imposes (`plant.speed: imposed`), as a test bench does: dissertation, chapter 3,
    where the driver regulates a power above the limit of packed snow and the car yet follows the cycle.
    """
    return drive_cycle(torque_of_level, p, car, c, s, period, now, body, pose, column, wheels)
