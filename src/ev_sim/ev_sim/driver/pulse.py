"""A driver who knows two positions of the accelerator."""

from __future__ import annotations

from dataclasses import dataclass

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.contract.signals import BodyPose, BodyVelocity, DriverCommand, Instant, SteeringColumnState, WheelStates
from ev_msgs_py.lockstep.methods import method
from ev_msgs_py.parameters.declaration import group, parameter
from ev_msgs_py.vehicle.car import Car
from ev_msgs_py.vehicle.layout import any_driven
from ev_sim.driver.cycle_driver import Cycle, CycleDriverParameters, CycleDriverState, cycle_of, drive_cycle
from ev_sim.driver.power_level import PowerLevelParameters, torque_of_power
from ev_sim.profiles.profile_file import with_speed_profile_from_file


@dataclass(frozen=True, slots=True)
class PulseParameters(CycleDriverParameters):
    """The cycle, the power, and when the foot goes down and up."""

    level: PowerLevelParameters = group(PowerLevelParameters)
    band: float = parameter(
        0.3,
        unit="m/s",
        low=0.0,
        high=10.0,
        about="the foot goes down this far below the cycle and up this far above it",
        source="assumption",
    )


@compilable
def torque_of_pulses(
    p: PulseParameters,
    car: Car,
    s: CycleDriverState,
    period: float,
    wanted: float,
    speed: float,
    wheels: WheelStates,
) -> float:
    """All of the power or nothing [N m]; the foot stays where it is within the band around the cycle."""
    if speed <= wanted - p.band:
        s.pressed = 1.0
    elif speed >= wanted + p.band:
        s.pressed = 0.0
    return torque_of_power(p.level, car, speed, wheels) if s.pressed == 1.0 else 0.0


@method(
    "driver",
    "pulse",
    PulseParameters,
    state=CycleDriverState,
    prepare=cycle_of,
    load_files=with_speed_profile_from_file,
    needs=(any_driven,),
    mirrored=True,
)
@compilable
def pulse(
    p: PulseParameters,
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
    """Follow a speed cycle with an accelerator that is either released or at a power above the limit of packed snow."""
    return drive_cycle(torque_of_pulses, p, car, c, s, period, now, body, pose, column, wheels)
