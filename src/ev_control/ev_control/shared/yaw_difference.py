"""The yaw rate that the steering asks for, and what drives left and right do for it."""

from __future__ import annotations

from dataclasses import dataclass

from ev_core.law import Car, InertialMeasurement, compilable, copysign, cos, parameter, sin


@dataclass(frozen=True, slots=True)
class YawDifferenceParameters:
    """Which yaw rate is wanted, and how firmly; all assumptions."""

    gain: float = parameter(
        10.0, unit="1/s", low=0.0, high=200.0, about="wanted yaw acceleration over the error of the yaw rate; 0: none"
    )
    yielding: float = parameter(
        0.2,
        unit="rad/s",
        low=0.01,
        high=10.0,
        about="error at which a wheel whose force turns the car the wrong way is allowed no slip",
    )
    deadband: float = parameter(0.02, unit="rad/s", low=0.0, high=1.0, about="error that is left alone")
    understeer: float = parameter(
        0.002, unit="rad s^2/m", low=0.0, high=0.1, about="road-wheel angle that the car needs more per m/s^2 across"
    )
    margin: float = parameter(
        1.0, unit="m/s^2", low=0.0, high=20.0, about="by which the yaw rate may ask for more than is measured across"
    )


@compilable
def yaw_error(
    p: YawDifferenceParameters, car: Car, speed: float, road_wheel_angle: float, imu: InertialMeasurement
) -> float:
    """Wanted minus measured yaw rate [rad/s], beyond the deadband.

    r* = V tan(delta)/(L + K V^2), the steady single-track model with K the understeer gradient, within what the road
    gives now, (|a_y| + margin)/|V|: no friction has to be known. V along the car's axis, negative in reverse [m/s].
    """
    steered = speed * sin(road_wheel_angle) / cos(road_wheel_angle) / (car.wheelbase + p.understeer * speed * speed)
    most = (abs(imu.lateral_acceleration) + p.margin) / max(abs(speed), 0.1)
    error = min(max(steered, -most), most) - imu.yaw_rate
    return copysign(max(abs(error) - p.deadband, 0.0), error)


@compilable
def yaw_difference(p: YawDifferenceParameters, car: Car, error: float) -> float:
    """Torque [N m] that each right wheel gets more and each left one less: M_z = J_z k (r* - r) by the driven axles."""
    track, axles = (car.front_track + car.rear_track) / 2.0, max(car.number_driven / 2.0, 1.0)
    return car.yaw_inertia * p.gain * error * car.wheel_radius / (track * axles)


@compilable
def slip_share(p: YawDifferenceParameters, error: float, turning: float) -> float:
    """Share of its slip [1] that a wheel keeps whose torque turns the car to the left (`turning` > 0) or right."""
    return 1.0 if turning * error >= 0.0 else max(1.0 - abs(error) / p.yielding, 0.0)
