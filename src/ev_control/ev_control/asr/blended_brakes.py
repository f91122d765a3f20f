"""ABS and stability control through the drives, with friction brakes that do the slow part; no source has equations."""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.estimation.plausible import is_plausible
from ev_control.estimation.reference_speed import (
    ReferenceSpeedParameters,
    ReferenceSpeedState,
    StandstillParameters,
    rolling_speeds,
)
from ev_control.shared.blended_wheel import (
    BlendedWheel,
    BlendingParameters,
    SlipLimitParameters,
    WheelAlong,
    YawDifferenceParameters,
    blended,
    forget_slip_limit,
    slip_limited,
    slip_share,
    yaw_difference,
    yaw_error,
)
from ev_control.shared.traction_control import sign
from ev_core.law import (
    NO_WHEELS,
    Car,
    InertialMeasurement,
    SteeringColumnState,
    Vehicle,
    Wheels,
    WheelStates,
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
        1.0, unit="m/s", low=0.1, high=10.0, about="speed of the car below which brakes pass, and wheels may lock"
    )
    slip: SlipLimitParameters = group(SlipLimitParameters)
    yaw: YawDifferenceParameters = group(YawDifferenceParameters)
    reference: ReferenceSpeedParameters = group(
        ReferenceSpeedParameters, source="observer", slipping_rate=0.05, standstill=StandstillParameters(rate=1.0)
    )


@dataclass(slots=True)
class BlendedBrakesState:
    """What lasts between steps."""

    reference: ReferenceSpeedState = part(ReferenceSpeedState)
    velocity: list[float] = per_wheel(unit="rad/s", about="last wheel speeds")
    measured: float = entry(unit="1", about="whether there are last wheel speeds")
    wheels: list[BlendedWheel] = each_wheel(BlendedWheel)


def brakes_to_blend(_parameters: BlendedBrakesParameters, vehicle: Vehicle) -> str:
    """The plant would blend once more, and an engine does not brake as motors do."""
    return "vehicle.blend_brakes false and no engine" if vehicle.blend_brakes or vehicle.engine.peak_power > 0.0 else ""


@method(
    "asr",
    "blended_brakes",
    needs=(each_driven, brakes_to_blend),
    mirrored=True,
)
@compilable
def blended_brakes(
    p: BlendedBrakesParameters,
    car: Car,
    s: BlendedBrakesState,
    period: float,
    request: WheelTorqueRequest,
    column: SteeringColumnState,
    wheels: WheelStates,
    imu: InertialMeasurement,
) -> WheelTorqueCommand:
    """Keep the slip of every wheel, driving or braking: the drive does it fast, the friction brake slowly.

    Of each wheel the sum of drive and brake is wanted, M = M_drive - M_brake + side * difference, along the travel
    (`yaw_difference`), and limited by its slip (`slip_limited`; less slip for a wheel that turns the car the wrong
    way). Its friction brake goes towards what the drive cannot brake, or shall not, M_f' = (max(-M - u G, 0) - M_f)/T,
    within `slew` and never beyond the pedal's; G is what the drive can brake, u is `use` while the wheel is limited
    and else 1. The drive gives at once what is left, M + M_f within its range, against the friction brake, too. About
    rest brakes pass, and where drive and brake are asked for together, both. What cannot be measured passes as well.
    """
    drive, brake, velocity = request.drive, request.brake, wheels.velocity
    if not is_plausible(column, wheels, imu):
        s.measured = 0.0
        return passed(s, request)
    total = (drive[0] + drive[1]) + (drive[2] + drive[3])
    braked = brake != NO_WHEELS or total * s.reference.speed < 0.0
    direction = -sign(s.reference.speed) if braked else sign(total)
    rolling = rolling_speeds(p.reference, car, s.reference, period, velocity, column.road_wheel_angle, imu, direction)
    speed = s.reference.speed
    ahead = sign(speed) if abs(speed) >= p.standing else sign(total)
    if ahead == 0.0 or (braked and abs(speed) < p.standing):
        for i in range(4):
            s.velocity[i] = velocity[i]
        s.measured = 1.0
        return passed(s, request)
    error = yaw_error(p.yaw, car, speed, column.road_wheel_angle, imu) if p.yaw.gain > 0.0 else 0.0
    more = ahead * yaw_difference(p.yaw, car, error)
    torque = Wheels(
        of_wheel(p, car, s, 0, period, request, wheels, imu, rolling, ahead, error, more),
        of_wheel(p, car, s, 1, period, request, wheels, imu, rolling, ahead, error, more),
        of_wheel(p, car, s, 2, period, request, wheels, imu, rolling, ahead, error, more),
        of_wheel(p, car, s, 3, period, request, wheels, imu, rolling, ahead, error, more),
    )
    s.velocity[:] = velocity
    s.measured = 1.0
    w = s.wheels
    return WheelTorqueCommand(torque, Wheels(w[0].friction, w[1].friction, w[2].friction, w[3].friction))


@compilable
def of_wheel(
    p: BlendedBrakesParameters,
    car: Car,
    s: BlendedBrakesState,
    i: int,
    period: float,
    request: WheelTorqueRequest,
    wheels: WheelStates,
    imu: InertialMeasurement,
    rolling: Wheels,
    ahead: float,
    error: float,
    more: float,
) -> float:
    """The drive torque [N m] of a wheel, whose friction brake is then in its state."""
    w, side = s.wheels[i], -1.0 if i % 2 == 0 else 1.0
    drive, brake, velocity = request.drive[i], request.brake[i], wheels.velocity[i]
    if ahead * drive > 0.0 and brake > 0.0:
        forget_slip_limit(w.slip)
        w.friction = brake
        return drive
    wanted = ahead * drive - brake + side * more
    before = s.velocity[i] if s.measured == 1.0 else velocity
    motion = WheelAlong(
        ahead * velocity,
        ahead * rolling[i],
        ahead * (velocity - before) / period,
        ahead * imu.longitudinal_acceleration / car.wheel_radius,
        ahead * wheels.effort[i] - w.friction,
        i,
    )
    net = slip_limited(p.slip, car, w.slip, period, motion, wanted, slip_share(p.yaw, error, ahead * side * wanted))
    return ahead * blended(p, car, w, period, net, ahead * drive, brake, ahead, velocity, i)


@compilable
def passed(s: BlendedBrakesState, request: WheelTorqueRequest) -> WheelTorqueCommand:
    """The request, and nothing known of the wheels."""
    for i in range(4):
        forget_slip_limit(s.wheels[i].slip)
        s.wheels[i].friction = request.brake[i]
    return WheelTorqueCommand(request.drive, request.brake)
