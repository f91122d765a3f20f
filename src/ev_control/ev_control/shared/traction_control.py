"""What all traction controls share: which wheels they limit, when they let torques pass, and what they measure."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import inf
from typing import Any, NamedTuple

from ev_control.estimation.plausible import is_plausible
from ev_control.estimation.reference_speed import ReferenceSpeedParameters, ReferenceSpeedState, rolling_speeds
from ev_control.estimation.wheel_dynamics import WheelMotion
from ev_control.shared.limp_mode import LimpModeParameters, without_yaw
from ev_control.shared.torque_plausibility import PlausibilityState
from ev_core.law import NO_WHEELS, Car, Wheels, compilable, copysign, entry, part, per_wheel
from ev_msgs_py.contract.signals import (
    InertialMeasurement,
    SteeringColumnState,
    WheelStates,
    WheelTorqueCommand,
    WheelTorqueRequest,
)

# Slower than this a car is about to pull away, perhaps on a hill: its drives, told ahead, do not brake it as it rolls
# back, and a brake that is still pressed is about to be released.
PULLING_AWAY = 0.3  # [m/s]
STANDING = 0.1  # tread of a wheel that its brake still holds; far above the noise of wheel speeds [m/s]


@dataclass(slots=True)
class LimitedWheel:
    """What every traction control knows of a wheel; each law adds what it knows besides."""

    limit: float = entry(inf, unit="N m", about="largest torque that it gets")


@dataclass(slots=True)
class TractionControlState:
    """What every traction control knows of the car."""

    reference: ReferenceSpeedState = part(ReferenceSpeedState)
    velocity: list[float] = per_wheel(unit="rad/s", about="last wheel speeds")
    measured: float = entry(unit="1", about="whether there are last wheel speeds")
    direction: list[float] = per_wheel(unit="1", about="sign of the request that is watched; 0 where it just passes")
    motors: PlausibilityState = part(PlausibilityState)


class Measured(NamedTuple):
    """What a traction control measures."""

    column: SteeringColumnState
    wheels: WheelStates
    imu: InertialMeasurement


@compilable
def watch(
    limit_of: Callable[..., float],
    forget: Callable[..., None],
    reference: ReferenceSpeedParameters,
    p: Any,
    car: Car,
    s: Any,
    period: float,
    request: WheelTorqueRequest,
    measured: Measured,
) -> None:
    """Go on with the state by what was measured; the limits of the wheels are then those of this step.

    A wheel has no limit, and the law forgets it, where nothing is asked for, where any wheel of a car that moves is
    braked, and where a torque works against the travel of the car (regeneration). About rest, under a brake, a wheel
    that its brake holds keeps its limit, and one that turns is limited: it spins as the brake is released. Everything
    is counted in the direction of the request, so reverse mirrors forward. A measurement that is not finite or absurd
    changes nothing: the last limits stay. A driven wheel whose speed sensor is lost (`reference.trust`) gets at most
    the least limit of the others; where all are lost, torques pass.

    The state has `control`, a TractionControlState, and `wheels`, each of which has what a LimitedWheel has.
    `limit_of(p, car, wheel, period, motion, wanted)` goes on with the state of a wheel of which `wanted` [N m], above
    zero, is asked, and gives its largest torque [N m], or infinity. `forget(p, wheel)` puts it back to the start.
    """
    column, wheels, imu = measured.column, measured.wheels, measured.imu
    known, drive, velocity, effort = s.control, request.drive, wheels.velocity, wheels.effort
    if not is_plausible(column, wheels, imu):
        known.measured = 0.0
        return
    is_braked = request.brake != NO_WHEELS
    asked = sign((drive[0] + drive[1]) + (drive[2] + drive[3]))
    direction = -sign(known.reference.speed) if is_braked else asked
    rolling = rolling_speeds(reference, car, known.reference, period, velocity, column.road_wheel_angle, imu, direction)
    for i in range(4):
        if car.driven[i] == 0.0:
            continue
        ahead = sign(drive[i])
        against = -abs(known.reference.speed) if is_braked else ahead * known.reference.speed
        if against < -PULLING_AWAY:
            ahead = 0.0
        wheel = s.wheels[i]
        if ahead != known.direction[i]:
            known.direction[i] = ahead
            forget(p, wheel)
        is_held = is_braked and ahead * velocity[i] * car.wheel_radius < STANDING
        if ahead != 0.0 and not is_held:
            before = known.velocity[i] if known.measured == 1.0 else velocity[i]
            motion = WheelMotion(
                ahead * velocity[i],
                ahead * rolling[i],
                ahead * (velocity[i] - before) / period,
                ahead * effort[i] - request.brake[i],
                ahead * imu.longitudinal_acceleration,
                imu.longitudinal_acceleration,
                imu.lateral_acceleration,
                i,
                ahead,
                known.reference.speed,
                imu.yaw_rate,
                column.road_wheel_angle,
            )
            wheel.limit = max(limit_of(p, car, wheel, period, motion, abs(drive[i])), 0.0)
    if reference.trust.watch == 1.0:
        limit_unknown_wheels(forget, p, car, s)
    known.velocity[:] = velocity
    known.measured = 1.0


@compilable
def limited(
    limp: LimpModeParameters, car: Car, s: Any, period: float, request: WheelTorqueRequest, wheels: WheelStates
) -> WheelTorqueCommand:
    """The requested torques [N m], those of wheels with a limit not above it: never more, and never of the other sign.

    With `limp.watch` the partner of a lost motor mirrors it, within its own limit.
    """
    drive = request.drive
    torques = Wheels(
        within(drive[0], s.wheels[0].limit),
        within(drive[1], s.wheels[1].limit),
        within(drive[2], s.wheels[2].limit),
        within(drive[3], s.wheels[3].limit),
    )
    if limp.watch == 1.0:
        return without_yaw(limp.plausibility, car, s.control.motors, period, request, torques, wheels)
    return WheelTorqueCommand(torques, request.brake)


@compilable
def limit_unknown_wheels(forget: Callable[..., None], p: Any, car: Car, s: Any) -> None:
    """A driven wheel whose speed nobody knows gets at most what the most slippery of the others gets."""
    lost, least = s.control.reference.trust.lost, inf
    for i in range(4):
        if car.driven[i] == 1.0 and lost[i] == 0.0 and s.control.direction[i] != 0.0:
            least = min(least, s.wheels[i].limit)
    for i in range(4):
        if car.driven[i] == 1.0 and lost[i] == 1.0:
            forget(p, s.wheels[i])
            s.wheels[i].limit = least


@compilable
def within(torque: float, limit: float) -> float:
    """A torque, not larger than its limit in either direction [N m]."""
    return copysign(limit, torque) if abs(torque) > limit else torque


@compilable
def sign(number: float) -> float:
    """-1, 0 or 1."""
    if number > 0.0:
        return 1.0
    return -1.0 if number < 0.0 else 0.0
