"""What a control of the wheels does where a motor does not give what it is told: its partner gives the same."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from operator import attrgetter
from typing import Any

from ev_control.shared.torque_plausibility import (
    PARTNERS,
    PlausibilityParameters,
    PlausibilityState,
    expect,
    measured,
    watch_torques,
)
from ev_core.law import Car, Need, Vehicle, compilable, copysign, each_driven, equal_motors, group, setting
from ev_msgs_py.contract.signals import WheelStates, WheelTorqueCommand, WheelTorqueRequest
from ev_msgs_py.contract.wheels import NO_WHEELS, Wheels


@dataclass(frozen=True, slots=True)
class LimpModeParameters:
    """Whether lost motors are looked for, and when a motor counts as one."""

    watch: bool = setting(False, about="whether a lost motor is found by its torque, and its partner mirrors it")
    plausibility: PlausibilityParameters = group(PlausibilityParameters)


def limp_mode_for(group: str) -> Need:
    """The limp mode whose parameters are this group compares wheels that have equal motors of their own."""

    def lacks(parameters: Any, vehicle: Vehicle) -> str:
        if not attrgetter(group)(parameters).watch:
            return ""
        lacking = each_driven(parameters, vehicle) or equal_motors(parameters, vehicle)
        return f"{lacking} for {group}.watch" if lacking else ""

    return lacks


@compilable
def without_yaw(
    p: PlausibilityParameters,
    car: Car,
    s: PlausibilityState,
    period: float,
    request: WheelTorqueRequest,
    limited: Wheels,
    wheels: WheelStates,
) -> WheelTorqueCommand:
    """The torques of a request as they are `limited` [N m]; where a motor is lost, its partner gives what it gives.

    A lost motor leaves one of the axle's two torques to choose: with it the car keeps either its drive or the
    difference of left and right. It keeps the difference that was asked for, which is what turns the car; what traction
    control took away was not asked for. For each wheel the command is

    - the limited torque, to the bit, unless the motor of its partner is lost and its own is not,
    - else of the same sign and not larger, whatever the lost motor gives: never backwards, never beyond traction
      control, never against the brake,
    - less by what the lost motor gives beyond its own request: in sum not more than was asked for.

    `keep_difference` is for cars that their drives steer: where nobody brakes, the difference of the requests may be
    given whatever its sign is and however small the request, within traction control.

    A lost motor is told what was asked of it, so that it shows when it comes back: its partner then gives the same at
    once, and after `recovery` of torques that are not about zero it counts as sound.
    """
    watch_torques(p, car, s, period, wheels)
    drive = Wheels(
        as_partner(p, car, s, request, limited, wheels, 0),
        as_partner(p, car, s, request, limited, wheels, 1),
        as_partner(p, car, s, request, limited, wheels, 2),
        as_partner(p, car, s, request, limited, wheels, 3),
    )
    command = WheelTorqueCommand(drive, request.brake)
    expect(p, car, s, period, command, wheels)
    return command


@compilable
def as_partner(
    p: PlausibilityParameters,
    car: Car,
    s: PlausibilityState,
    request: WheelTorqueRequest,
    limited: Wheels,
    wheels: WheelStates,
    i: int,
) -> float:
    """The torque of wheel i [N m]: `limited`, or what its partner gives, if that alone is lost, and the difference."""
    j = PARTNERS[i]
    if s.lost[j] == 0.0 or s.lost[i] == 1.0:
        return limited[i]
    ahead = copysign(1.0, limited[i])
    gives, asked, of_lost = ahead * measured(wheels, j), ahead * request.drive[i], ahead * request.drive[j]
    difference, limit = asked - of_lost, abs(limited[i])
    least, most = 0.0, max(limit - max(gives - max(of_lost, 0.0), 0.0), 0.0)
    if p.keep_difference == 1.0 and request.brake == NO_WHEELS:
        reach = limit if limit < abs(asked) else inf
        least, most = min(max(difference, -reach), least), max(min(difference, reach), most)
    efficiency = car.motor.gear_efficiency
    alike = gives / efficiency if gives * (ahead * wheels.velocity[j]) >= 0.0 else gives * efficiency
    return ahead * min(max(alike + difference, least), most)
