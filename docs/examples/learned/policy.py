"""A learned yaw moment control: a small network, with weights as parameters (train.py)."""

from dataclasses import dataclass
from typing import NamedTuple

from ev_control.law import BrakeSplitParameters, split_brake
from ev_core.law import (
    Car,
    DriverCommand,
    InertialMeasurement,
    ParameterError,
    SteeringColumnState,
    Vehicle,
    Wheels,
    WheelStates,
    WheelTorqueRequest,
    compilable,
    group,
    method,
    parameter,
)

INPUTS, HIDDEN = 4, 3
WEIGHTS = (INPUTS + 1) * HIDDEN


@dataclass(frozen=True, slots=True)
class PolicyParameters:
    """What was learned, and how much of it acts."""

    weights: tuple[float, ...] = parameter(
        (0.0,) * WEIGHTS,
        unit="1",
        low=-100.0,
        high=100.0,
        about="of the network, node by node, its output last",
    )
    largest: float = parameter(
        4000.0, unit="N m", low=0.0, high=1e5, about="largest moment on the car"
    )
    slowest: float = parameter(
        3.0, unit="m/s", low=0.1, high=50.0, about="below it no moment is asked for"
    )
    brake: BrakeSplitParameters = group(BrakeSplitParameters)

    def __post_init__(self) -> None:
        if len(self.weights) != WEIGHTS:
            raise ParameterError(f"weights has {len(self.weights)} elements, expected {WEIGHTS}")


class Prepared(NamedTuple):
    """What the law is given once."""

    weights: tuple[float, ...]


def prepare(parameters: PolicyParameters, _vehicle: Vehicle, _period: float) -> Prepared:
    """The weights."""
    return Prepared(parameters.weights)


@compilable
def bent(value: float) -> float:
    """Between -1 and 1, odd, by exact operations alone."""
    return value / (1.0 + abs(value))


@compilable
def share_of_moment(
    weights: tuple[float, ...], error: float, turning: float, across: float, steered: float
) -> float:
    """The output of the network, between -1 and 1.

    That is w_h f(w_h1 x_1 + ... + w_h4 x_4) over all nodes h, through f.

    Without offsets it is odd: a mirrored car in mirrored motion gets the mirrored moment.
    """
    total = 0.0
    for node in range(HIDDEN):
        at = (INPUTS + 1) * node
        excited = (weights[at] * error + weights[at + 1] * turning) + (
            weights[at + 2] * across + weights[at + 3] * steered
        )
        total += weights[at + 4] * bent(excited)
    return bent(total)


@compilable
def inputs(
    car: Car, speed: float, angle: float, yaw_rate: float, lateral_acceleration: float
) -> Wheels:
    """Inputs, each about 1: error to a neutral car, turning, acceleration across, steering."""
    turning = speed * yaw_rate
    return Wheels(
        (speed * speed * angle / car.wheelbase - turning) / 5.0,
        turning / 5.0,
        lateral_acceleration / 5.0,
        angle / 0.1,
    )


@compilable
def speed_of(car: Car, turning: Wheels) -> float:
    """Of the car, by the mean of its wheels [m/s]."""
    return ((turning[0] + turning[1]) + (turning[2] + turning[3])) * car.wheel_radius / 4.0


@compilable
def drive_torques(car: Car, total: float, moment: float) -> Wheels:
    """Equal torques of all drives, and a moment by differences on axles that have two."""
    front, rear = car.driven[0] * car.driven[1], car.driven[2] * car.driven[3]
    force = moment / max(front * car.front_track + rear * car.rear_track, 1e-3)
    equal, half = total / car.number_driven, force * car.wheel_radius
    return Wheels(
        equal * car.driven[0] - half * front,
        equal * car.driven[1] + half * front,
        equal * car.driven[2] - half * rear,
        equal * car.driven[3] + half * rear,
    )


@method("electronic_differential", "learned", prepare=prepare, mirrored=True)
@compilable
def learned(
    p: PolicyParameters,
    car: Car,
    c: Prepared,
    driver: DriverCommand,
    column: SteeringColumnState,
    wheels: WheelStates,
    imu: InertialMeasurement,
) -> WheelTorqueRequest:
    """The moment of the network by differences of drive torques, by sensors alone."""
    speed, moment = speed_of(car, wheels.velocity), 0.0
    if speed > p.slowest:
        x = inputs(car, speed, column.road_wheel_angle, imu.yaw_rate, imu.lateral_acceleration)
        moment = p.largest * share_of_moment(c.weights, x[0], x[1], x[2], x[3])
    drive = drive_torques(car, driver.drive_torque, moment)
    return WheelTorqueRequest(drive, split_brake(p.brake, driver))
