"""Steered rear wheels: by a ratio over speed, or so that the sideslip angle stays zero.

How it works: a law gives the wanted angle of the rear wheels, and the motor of `actuated` turns
them there against the moment of the road. The plant with the option `rear_steering` reads their
angle and rate.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import NamedTuple

from ev_core.law import (
    Car,
    ParameterError,
    RearSteeringState,
    Vehicle,
    compilable,
    method,
    parameter,
)
from ev_msgs_py.contract.signals import BodyVelocity, SteeringColumnState, TireForces
from ev_sim.profiles.profile import BY_LINES, Profile, profile_of, value_at
from ev_sim.steering.actuated import Servo, SteeringMotorParameters, SteeringMotorState, servo, turn
from ev_sim.understeer import axle_cornering_stiffnesses

_LEAST_ARM = 0.1  # of the front axle's


@compilable
def shown(p: SteeringMotorParameters, s: SteeringMotorState) -> RearSteeringState:
    """Wheels and motor at this instant."""
    return RearSteeringState(s.angle, s.rate, p.gear_ratio * s.rate, s.torque, s.power)


@compilable
def moment_of_road(p: SteeringMotorParameters, tyres: TireForces) -> float:
    """Moment of the road on the rear wheels [N m].

    The side forces act behind the steering axes by the trail and turn the wheels back.
    """
    return -p.trail * (tyres.lateral_force.rear_left + tyres.lateral_force.rear_right)


class AtAxles(NamedTuple):
    """Signals that steer the rear wheels: front wheels, motion, and the forces of the tyres."""

    column: SteeringColumnState
    velocity: BodyVelocity
    tyres: TireForces


# The method of a law of the rear wheels' angle; other plants do not turn their rear wheels by it.
rear_steering = partial(
    method,
    "rear_steering",
    outputs=shown,
    requires={"plant.rear_steering": True},
    mirrored=True,
)


@dataclass(frozen=True, slots=True)
class SpeedDependentParameters(SteeringMotorParameters):
    """The ratio of the angles over speed, and the motor."""

    speed: tuple[float, ...] = parameter(
        (0.0, 10.0, 15.0, 30.0), unit="m/s", low=0.0, about="speeds of the points, increasing"
    )
    ratio: tuple[float, ...] = parameter(
        (-0.4, -0.2, 0.0, 0.3),
        unit="1",
        low=-1.0,
        high=1.0,
        about="angle of the rear wheels over that of the front ones at these speeds, linear "
        "between them",
    )

    def __post_init__(self) -> None:
        if not self.speed or len(self.speed) != len(self.ratio):
            raise ParameterError(
                f"speed and ratio have {len(self.speed)} and {len(self.ratio)} elements, expected "
                f"the same number,"
                " at least one"
            )
        for lower, higher in pairwise(self.speed):
            if not lower < higher:
                raise ParameterError(
                    f"speed: {higher:g} m/s after {lower:g} m/s is refused, expected increasing"
                )


class SpeedDependentConstants(NamedTuple):
    """The motor, and the ratio over speed."""

    servo: Servo
    ratio: Profile


def speed_dependent_constants(
    p: SpeedDependentParameters, _vehicle: Vehicle, period: float
) -> SpeedDependentConstants:
    """The motor over a period [s]."""
    return SpeedDependentConstants(servo(p, period), profile_of(p.speed, p.ratio, BY_LINES))


@rear_steering("speed_dependent", prepare=speed_dependent_constants)
@compilable
def speed_dependent(
    p: SpeedDependentParameters,
    c: SpeedDependentConstants,
    s: SteeringMotorState,
    read: AtAxles,
) -> None:
    """Turn the rear wheels by a share of the front angle over speed, delta_r = k(|V|) delta_f."""
    wanted = value_at(c.ratio, abs(read.velocity.longitudinal)) * read.column.road_wheel_angle
    turn(p, c.servo, s, wanted, moment_of_road(p, read.tyres))


class ZeroSideslipConstants(NamedTuple):
    """The motor, and the cornering stiffnesses C_1, C_2 of the axles at static load [N/rad].

    They are those on dry asphalt.
    """

    servo: Servo
    forwards: tuple[float, float]
    reverse: tuple[float, float]


def zero_sideslip_constants(
    p: SteeringMotorParameters, vehicle: Vehicle, period: float
) -> ZeroSideslipConstants:
    """The motor over a period [s], and the axles of the vehicle."""
    forwards, reverse = (axle_cornering_stiffnesses(vehicle, ahead=ahead) for ahead in (1.0, -1.0))
    return ZeroSideslipConstants(servo(p, period), forwards, reverse)


@rear_steering("zero_sideslip", prepare=zero_sideslip_constants)
@compilable
def zero_sideslip(
    p: SteeringMotorParameters,
    car: Car,
    c: ZeroSideslipConstants,
    s: SteeringMotorState,
    read: AtAxles,
) -> None:
    """Turn the rear wheels so that the linear car of its own tyres turns without sideslip.

    With forces m V r b/L in front and m V r a/L behind, slip angles delta_f - a r/V and delta_r + b
    r/V, and V_y = 0: delta_r/delta_f = (m a V|V|/(L C_2) - b)/(m b V|V|/(L C_1) + a), a and b from
    the centre of mass to the axles.
    """
    # The lengths of the docstring: a in front of the centre of mass, b behind it.
    b = car.centre_of_mass_to_rear_axle
    a = car.wheelbase - b
    speed = read.velocity.longitudinal
    front, rear = c.forwards if speed >= 0.0 else c.reverse
    squared = car.mass * speed * abs(speed) / car.wheelbase
    # In reverse the front wheels turn the car ever more, until no angle of the rear wheels could go
    # with theirs.
    ratio = (a * squared / rear - b) / max(b * squared / front + a, _LEAST_ARM * a)
    turn(p, c.servo, s, ratio * read.column.road_wheel_angle, moment_of_road(p, read.tyres))
