"""Rear wheels against the front ones at low speed, with them at high speed."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.contract.signals import BodyVelocity, SteeringColumnState, TireForces
from ev_msgs_py.lockstep.methods import method
from ev_msgs_py.parameters.declaration import ParameterError, parameter
from ev_msgs_py.vehicle.description import Vehicle
from ev_sim.profiles.profile import LINEAR, Profile, profile_of, value_at
from ev_sim.rear_steering.rear_axle import PLANT, moment_of_road, shown
from ev_sim.steering_actuator.motor import Servo, SteeringMotorParameters, SteeringMotorState, servo, turn


@dataclass(frozen=True, slots=True)
class SpeedDependentParameters(SteeringMotorParameters):
    """The ratio of the angles over speed, and the motor."""

    speed: tuple[float, ...] = parameter(
        (0.0, 10.0, 15.0, 30.0), unit="m/s", low=0.0, about="speeds of the points, increasing", source="assumption"
    )
    ratio: tuple[float, ...] = parameter(
        (-0.4, -0.2, 0.0, 0.3),
        unit="1",
        low=-1.0,
        high=1.0,
        about="angle of the rear wheels over that of the front ones at these speeds, linear between them",
        source="assumption",
    )

    def __post_init__(self) -> None:
        if not self.speed or len(self.speed) != len(self.ratio):
            raise ParameterError(
                f"speed and ratio have {len(self.speed)} and {len(self.ratio)} elements, allowed is the same number,"
                " at least one"
            )
        for lower, higher in pairwise(self.speed):
            if not lower < higher:
                raise ParameterError(f"speed: {higher:g} m/s after {lower:g} m/s is refused, allowed is increasing")


class SpeedDependentConstants(NamedTuple):
    """The motor, and the ratio over speed."""

    servo: Servo
    ratio: Profile


def prepare(p: SpeedDependentParameters, _vehicle: Vehicle, period: float) -> SpeedDependentConstants:
    """The motor over a period [s]."""
    return SpeedDependentConstants(servo(p, period), profile_of(p.speed, p.ratio, LINEAR))


@method(
    "rear_steering",
    "speed_dependent",
    SpeedDependentParameters,
    state=SteeringMotorState,
    prepare=prepare,
    outputs=shown,
    requires=PLANT,
    mirrored=True,
)
@compilable
def speed_dependent(
    p: SpeedDependentParameters,
    c: SpeedDependentConstants,
    s: SteeringMotorState,
    column: SteeringColumnState,
    velocity: BodyVelocity,
    tyres: TireForces,
) -> None:
    """Turn the rear wheels by a share of the front angle that depends on speed, delta_r = k(|V|) delta_f."""
    wanted = value_at(c.ratio, abs(velocity.longitudinal)) * column.road_wheel_angle
    turn(p, c.servo, s, wanted, moment_of_road(p, tyres))
