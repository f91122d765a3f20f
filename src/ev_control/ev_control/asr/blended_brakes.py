"""ABS and stability control through the drives, with friction brakes that do the slow part.

How it works: of each wheel one torque is wanted, drive less brake along the travel of the car, and
left and right differ by what the yaw rate lacks. The slip of the wheel limits that torque. What the
drive can brake it does at once; the rest goes to the friction brake, which follows slowly, and the
drive makes up for it meanwhile. No source has equations.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from ev_control.estimation.plausible import is_plausible
from ev_control.estimation.reference_speed import (
    ReferenceSpeedParameters,
    ReferenceSpeedState,
    Source,
    StandstillParameters,
    rolling_speeds,
)
from ev_control.shared.blended_wheel import (
    BlendedWheel,
    BlendingParameters,
    SlipLimitParameters,
    WheelAlong,
    WheelDemand,
    YawDifferenceParameters,
    blended,
    drive_range,
    forget_slip_limit,
    slip_limited,
    slip_share,
    yaw_difference,
    yaw_error,
)
from ev_control.shared.traction_control import Measured, sign
from ev_core.law import (
    NO_WHEELS,
    Car,
    Vehicle,
    Wheels,
    WheelTorqueCommand,
    WheelTorqueRequest,
    compilable,
    each_driven,
    each_wheel,
    entry,
    group,
    method,
    parameter,
    part,
    per_wheel,
)


@dataclass(frozen=True, slots=True)
class BlendedBrakesParameters(BlendingParameters):
    """Shares of drives and brakes, limits, and estimates of the car; all assumptions."""

    standing: float = parameter(
        1.0,
        unit="m/s",
        low=0.1,
        high=10.0,
        about="speed of the car below which brakes pass, and wheels may lock",
    )
    slip: SlipLimitParameters = group(SlipLimitParameters)
    yaw: YawDifferenceParameters = group(YawDifferenceParameters)
    reference: ReferenceSpeedParameters = group(
        ReferenceSpeedParameters,
        source=Source.OBSERVER,
        slipping_rate=0.05,
        standstill=StandstillParameters(rate=1.0),
    )


@dataclass(slots=True)
class BlendedBrakesState:
    """State of the car and of its wheels."""

    reference: ReferenceSpeedState = part(ReferenceSpeedState)
    velocity: list[float] = per_wheel(unit="rad/s", about="last wheel speeds")
    measured: bool = entry(False, unit="1", about="whether there are last wheel speeds")
    wheels: list[BlendedWheel] = each_wheel(BlendedWheel)


class Travel(NamedTuple):
    """Everything about a step that is the same for all wheels."""

    period: float  # [s]
    measured: Measured
    rolling: Wheels  # speeds at which the wheels would roll [rad/s]
    ahead: float  # 1 forwards, -1 in reverse
    yaw_error: float  # wanted minus measured yaw rate [rad/s]
    difference: float  # torque that each right wheel gets more, along the travel [N m]


def brakes_to_blend(_parameters: BlendedBrakesParameters, vehicle: Vehicle) -> str:
    """Refuse a plant that would blend once more, and an engine, which brakes in another way."""
    if vehicle.blend_brakes or vehicle.engine.peak_power > 0.0:
        return "vehicle.blend_brakes false and no engine"
    return ""


@method("asr", "blended_brakes", needs=(each_driven, brakes_to_blend), mirrored=True)
@compilable
def blended_brakes(
    p: BlendedBrakesParameters,
    car: Car,
    s: BlendedBrakesState,
    period: float,
    measured: Measured,
) -> WheelTorqueCommand:
    """Keep the slip of every wheel: the drive does it fast, the friction brake slowly.

    Of each wheel the sum of drive and brake is wanted, M = M_drive - M_brake + side * difference,
    along the travel (`yaw_difference`), and limited by its slip (`slip_limited`; less slip for a
    wheel that turns the car the wrong way). Its friction brake goes towards what the drive cannot
    brake, or shall not, M_f' = (max(-M - u G, 0) - M_f)/T, within `slew` and never beyond the
    pedal's; G is what the drive can brake, u is `use` while the wheel is limited and else 1. The
    drive gives at once what is left, M + M_f within its range, against the friction brake, too.
    About rest brakes pass, and where drive and brake are asked for together, both. What cannot be
    measured passes as well.
    """
    request, sensors = measured.request, measured.sensors
    if not is_plausible(sensors):
        s.measured = False
        return passed(s, request)
    drive, velocity = request.drive, sensors.wheels.velocity
    total = (drive[0] + drive[1]) + (drive[2] + drive[3])
    # Regeneration slows down, too, so the fastest wheel shows the speed.
    braked = request.brake != NO_WHEELS or total * s.reference.speed < 0.0
    direction = -sign(s.reference.speed) if braked else sign(total)
    rolling = rolling_speeds(p.reference, car, s.reference, period, sensors, direction)
    speed = s.reference.speed
    # About rest the sign of the speed is noise, and the request shows where the car is to go.
    ahead = sign(speed) if abs(speed) >= p.standing else sign(total)
    if ahead == 0.0 or (braked and abs(speed) < p.standing):
        s.velocity[:] = velocity
        s.measured = True
        return passed(s, request)
    error = 0.0
    if p.yaw.gain > 0.0:
        error = yaw_error(p.yaw, car, speed, sensors.column.road_wheel_angle, sensors.imu)
    difference = ahead * yaw_difference(p.yaw, car, error)
    now = Travel(period, measured, rolling, ahead, error, difference)
    torque = Wheels(
        of_wheel(p, car, s, now, 0),
        of_wheel(p, car, s, now, 1),
        of_wheel(p, car, s, now, 2),
        of_wheel(p, car, s, now, 3),
    )
    s.velocity[:] = velocity
    s.measured = True
    w = s.wheels
    friction = Wheels(w[0].friction, w[1].friction, w[2].friction, w[3].friction)
    return WheelTorqueCommand(torque, friction)


@compilable
def of_wheel(
    p: BlendedBrakesParameters, car: Car, s: BlendedBrakesState, now: Travel, i: int
) -> float:
    """Drive torque [N m] of a wheel; its friction brake goes on in the state."""
    w = s.wheels[i]
    ahead = now.ahead
    side = -1.0 if i % 2 == 0 else 1.0
    request, sensors = now.measured.request, now.measured.sensors
    drive = request.drive[i]
    brake = request.brake[i]
    velocity = sensors.wheels.velocity[i]
    # Drive against brake, as on a hill: both pass, and nothing is regulated.
    if ahead * drive > 0.0 and brake > 0.0:
        forget_slip_limit(w.slip)
        w.friction = brake
        return drive
    wanted = ahead * drive - brake + side * now.difference
    before = s.velocity[i] if s.measured else velocity
    motion = WheelAlong(
        ahead * velocity,
        ahead * now.rolling[i],
        ahead * (velocity - before) / now.period,
        ahead * sensors.imu.longitudinal_acceleration / car.wheel_radius,
        # The friction brake is not measured: it is taken as it was commanded last.
        ahead * sensors.wheels.effort[i] - w.friction,
        car.driven_wheel_inertia[i],
    )
    share = slip_share(p.yaw, now.yaw_error, ahead * side * wanted)
    net = slip_limited(p.slip, w.slip, now.period, motion, wanted, share)
    can = drive_range(car, i, velocity, ahead)
    return ahead * blended(p, w, now.period, can, WheelDemand(net, ahead * drive, brake))


@compilable
def passed(s: BlendedBrakesState, request: WheelTorqueRequest) -> WheelTorqueCommand:
    """Pass the request on, and forget all wheels."""
    for i in range(4):
        forget_slip_limit(s.wheels[i].slip)
        s.wheels[i].friction = request.brake[i]
    return WheelTorqueCommand(request.drive, request.brake)
