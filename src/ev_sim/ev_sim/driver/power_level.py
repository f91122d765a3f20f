"""A pedal that stands for a power: somewhat more than packed snow can carry."""

from __future__ import annotations

from dataclasses import dataclass

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.contract.signals import WheelStates
from ev_msgs_py.parameters.declaration import parameter
from ev_msgs_py.vehicle.car import GRAVITY, Car


@dataclass(frozen=True, slots=True)
class PowerLevelParameters:
    """How much the driver asks for; the source says no more than above the limit of packed snow."""

    factor: float = parameter(
        1.11,
        unit="1",
        low=0.0,
        high=10.0,
        about="power over that of the limit, k",
        source="fitted on method 2 alone (docs/dissertation.md)",
    )
    friction: float = parameter(
        0.4022,
        unit="1",
        low=0.0,
        high=2.0,
        about="friction of the limit",
        source="dissertation, table 2.3: peak of packed snow 1",
    )
    slip: float = parameter(
        0.0907,
        unit="1",
        low=0.0,
        high=0.9,
        about="slip at the limit",
        source="dissertation, table 2.3: slip of that peak",
    )
    rolling_resistance: float = parameter(
        0.083,
        unit="1",
        low=0.0,
        high=0.5,
        about="rolling resistance that a wheel overcomes before it slips",
        source="dissertation, table 2.2: packed snow, middle of its range, and f_0 of the vehicle",
    )
    slowest: float = parameter(
        1.0,
        unit="m/s",
        low=0.01,
        high=10.0,
        about="below this speed the level is a torque, for a power gives none at rest",
        source="assumption",
    )


@compilable
def torque_of_power(p: PowerLevelParameters, car: Car, speed: float, wheels: WheelStates) -> float:
    """Drive torque of all wheels together [N m] at a speed of the car [m/s], forwards.

    That of a power P = k (friction + rolling resistance) W V/(1 - slip). W is the load of the driven wheels at rest;
    with k = 1 that is the power at which they all turn at the slip of the limit. The torque is P over the mean speed of
    the driven wheels, so it falls where they spin: a drive that is told a power gives just that.
    """
    front = car.centre_of_mass_to_rear_axle / car.wheelbase
    driven, velocity = car.driven, wheels.velocity
    share = 0.0
    for i in range(4):
        if driven[i] == 1.0:
            share += (front if i < 2 else 1.0 - front) / 2.0
    # Left and right first, so that a mirrored car gets the same number.
    turning = (driven[0] * velocity[0] + driven[1] * velocity[1]) + (driven[2] * velocity[2] + driven[3] * velocity[3])
    load = car.mass * GRAVITY * share
    power = p.factor * (p.friction + p.rolling_resistance) * load / (1.0 - p.slip) * max(speed, p.slowest)
    return power / max(turning / car.number_driven, p.slowest / car.wheel_radius)
