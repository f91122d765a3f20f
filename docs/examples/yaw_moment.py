"""A law of your own that controls the car: a yaw moment by the wheel torques, proportional and integral, or sliding."""

from dataclasses import dataclass
from enum import auto

from ev_control.law import BrakeSplitParameters, differential, split_brake
from ev_core.law import (
    GRAVITY,
    BodyVelocity,
    Car,
    Choice,
    DriverCommand,
    SteeringColumnState,
    Wheels,
    WheelTorqueRequest,
    compilable,
    entry,
    group,
    parameter,
)


class Control(Choice):
    """What makes a moment of the error."""

    PI = auto()
    SLIDING_MODE = auto()


@dataclass(frozen=True, slots=True)
class YawMomentParameters:
    """The yaw rate that is wanted, and how it is brought about."""

    control: Control = parameter(Control.PI, about="from the error of the yaw rate to a moment")
    understeer: float = parameter(
        0.0,
        unit="s^2/m",
        low=-1.0,
        high=1.0,
        about="K of the wanted yaw rate v delta/(L + K v^2); 0: a neutral car",
    )
    friction: float = parameter(
        0.8, unit="1", low=0.01, high=2.0, about="of the road; the wanted yaw rate is below mu g/v"
    )
    gain: float = parameter(
        5000.0, unit="N m s/rad", low=0.0, high=1e6, about="moment per error of the yaw rate"
    )
    reset_time: float = parameter(
        0.5, unit="s", low=0.01, high=1e3, about="of the integral of `pi`"
    )
    layer: float = parameter(
        0.05,
        unit="rad/s",
        low=1e-4,
        high=10.0,
        about="error within which `sliding_mode` is linear, against chatter",
    )
    largest: float = parameter(
        2000.0, unit="N m", low=0.0, high=1e5, about="largest moment on the car"
    )
    slowest: float = parameter(
        2.0, unit="m/s", low=0.1, high=50.0, about="below it no moment is asked for"
    )
    brake: BrakeSplitParameters = group(BrakeSplitParameters)


@dataclass(slots=True)
class YawMomentState:
    """What lasts between steps."""

    integral: float = entry(unit="N m", about="integral part of the moment")


@differential("yaw_moment")
@compilable
def yaw_moment(
    p: YawMomentParameters,
    car: Car,
    s: YawMomentState,
    period: float,
    driver: DriverCommand,
    column: SteeringColumnState,
    body: BodyVelocity,
) -> WheelTorqueRequest:
    """Turn the car as a neutral one would, by a difference of the torques on each axle that has two drives.

    M_z = K (e + integral of e/T_i), or M_max sat(e/layer), with e = r_wanted - r, both within the
    largest moment; of an axle it is (M_right - M_left) d/(2 r_k).
    """
    speed, moment = body.longitudinal, 0.0
    if speed >= p.slowest:
        limit = p.friction * GRAVITY / speed
        wanted = speed * column.road_wheel_angle / (car.wheelbase + p.understeer * speed * speed)
        error = min(max(wanted, -limit), limit) - body.yaw_rate
        if p.control == Control.SLIDING_MODE:
            moment = p.largest * min(max(error / p.layer, -1.0), 1.0)
        else:
            s.integral = min(
                max(s.integral + p.gain * error * period / p.reset_time, -p.largest), p.largest
            )
            moment = min(max(p.gain * error + s.integral, -p.largest), p.largest)
    else:
        s.integral = 0.0
    front, rear = car.driven[0] * car.driven[1], car.driven[2] * car.driven[3]
    force = moment / max(front * car.front_track + rear * car.rear_track, 1e-3)
    equal, half = driver.drive_torque / car.number_driven, force * car.wheel_radius
    drive = Wheels(
        equal * car.driven[0] - half * front,
        equal * car.driven[1] + half * front,
        equal * car.driven[2] - half * rear,
        equal * car.driven[3] + half * rear,
    )
    return WheelTorqueRequest(drive, split_brake(p.brake, driver))
