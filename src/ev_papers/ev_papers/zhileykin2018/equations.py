"""Eqs 4, 5 and 7 of Zhileykin (2018): the shares that the law asks for, and the N that they leave.

The law is asked once, away from a run, at an acceleration and a steering angle of our choice. N is
the excitation of the sideslip model W12, which the source makes zero to derive its equations.

Each public function measures one number of published.csv.
"""

from __future__ import annotations

import dataclasses
import math
from typing import NamedTuple

from ev_core.lockstep.finding import find_method
from ev_core.methods.method_record import create
from ev_core.parameters.declaration import flatten
from ev_core.parameters.values import build
from ev_msgs_py.contract.signals import (
    BodyVelocity,
    DriverCommand,
    InertialMeasurement,
    SteeringColumnState,
    WheelStates,
)
from ev_msgs_py.contract.wheels import NO_WHEELS, Wheels
from ev_study.analysis.linear_models import SideSlipModel, side_slip_model
from ev_study.verdicts.need import ScenarioRuns

FORCE = 3000.0  # X, that the driver asks for [N]
SPEED = 8.0  # V [m/s]
ACCELERATION = 1.0  # j [m/s^2]
ANGLE = 0.1  # Theta [rad]
BRAKING = 2500.0  # of the engine [N], as in zhileykin2018_braking
OBLIQUE = math.acos(0.8)  # phi at which eq 5 and the line above it differ [rad]
_ROLE = "electronic_differential"


class Shares(NamedTuple):
    """Shares of the front axle in the torque of the car, of the rear wheels in their axle [1]."""

    front: float
    slower: float
    faster: float


def _shares(
    driven: ScenarioRuns,
    phi: float = 0.0,
    road_wheel_angle: float = 0.0,
    **readings: object,
) -> Shares:
    """Answer of the law to ACCELERATION at an angle phi to the car's axis, and a road-wheel angle.

    Both are in [rad]. Car and parameters are those that were driven, but for the `readings`. The
    left rear wheel is the slower one, and the car has no slip angle that would choose a branch.
    """
    method = find_method(_ROLE, "axle_redistribution")
    vehicle = driven.vehicle
    known = flatten(method.parameters())
    # A run with another law has parameters that this one does not know.
    given = {
        name: value for name, value in driven.parameters.get(_ROLE, {}).items() if name in known
    }
    law = create(method, build(method.parameters, {**given, **readings}), vehicle, 0.01)
    signals = (
        DriverCommand(FORCE * vehicle.wheel_radius, 0.0, 0.0),
        SteeringColumnState(0.0, 0.0, 0.0, road_wheel_angle, 0.0),
        WheelStates(NO_WHEELS, Wheels(20.0, 20.0, 20.0, 21.0), NO_WHEELS),
        InertialMeasurement(0.0, ACCELERATION * math.cos(phi), ACCELERATION * math.sin(phi)),
        BodyVelocity(SPEED, SPEED * math.tan(road_wheel_angle / 2), 0.0),
    )
    by_kind = {type(signal): signal for signal in signals}
    drive = law.step(*(by_kind[kind] for kind in method.reads)).drive
    front = drive.front_left + drive.front_right
    rear = drive.rear_left + drive.rear_right
    return Shares(front / (front + rear), drive.rear_left / rear, drive.rear_right / rear)


def _model(driven: ScenarioRuns, acceleration: float, front_share: float) -> SideSlipModel:
    return side_slip_model(driven.vehicle, SPEED, acceleration, FORCE, front_share)


def excitation_by_eq_4(driven: ScenarioRuns) -> float:
    """N of W12 with the front share of eq 4 as an equality [1/s]."""
    found = _shares(driven, factor="equality")
    return _model(driven, ACCELERATION, found.front).excitation


def excitation_by_eq_5(driven: ScenarioRuns) -> float:
    """N of W12 with h_i of eq 5, read as below it: the line above it makes N zero [1/s]."""
    found = _shares(driven, OBLIQUE, factor="equality", first_branch="rear")
    return _model(driven, ACCELERATION * math.cos(OBLIQUE), found.front).excitation


def excitation_by_front_share(driven: ScenarioRuns) -> float:
    """The same with h of eq 5 as the front share, h_n = 1/(lambda_0 + 1) [1/s].

    Then the line above eq 5 is that of the rear share, 1 - h_n.
    """
    found = _shares(
        driven,
        OBLIQUE,
        factor="equality",
        first_branch="rear",
        second_branch="rear_share",
        largest_front_share=0.9,  # more than 1 - K cos(phi) is here
    )
    return _model(driven, ACCELERATION * math.cos(OBLIQUE), 1.0 - found.front).excitation


def excitation_by_the_engine(driven: ScenarioRuns, front_share: float) -> float:
    """N of W12 at 15 m/s where the engine brakes with 2500 N [1/s]; above zero it oversteers."""
    model = side_slip_model(
        driven.vehicle, 15.0, -BRAKING / driven.vehicle.mass, -BRAKING, front_share
    )
    return model.excitation


def excitation_by_eq_7(driven: ScenarioRuns) -> float:
    """N of W12 with the rear shares of eq 7, at constant speed and w_z = V Theta/L [1/s]."""
    found = _shares(driven, road_wheel_angle=ANGLE)
    model = dataclasses.replace(
        _model(driven, 0.0, found.front),
        rear_difference=found.slower - found.faster,
        yaw_rate=SPEED * ANGLE / driven.vehicle.wheelbase,
    )
    return model.excitation


def front_share(driven: ScenarioRuns, angle: float, branch: str) -> float:
    """Front share at an angle phi, in multiples of pi, by the equation of a branch [1].

    By itself, without the rule on slowing down, which comes before it where j_x <= 0.
    """
    return _shares(driven, angle * math.pi, first_branch=branch, braking="command").front


def front_share_when_slowing_down(driven: ScenarioRuns) -> float:
    """Front share at phi = pi, with that rule [1]."""
    return _shares(driven, math.pi, first_branch="rear").front


def _rear_difference(driven: ScenarioRuns) -> float:
    """Difference q of the shares of the rear wheels by eq 7 at a front share of a half [1]."""
    return driven.vehicle.wheelbase * ANGLE / (2 * driven.vehicle.rear_track)


def error_of_the_slower(driven: ScenarioRuns) -> float:
    """Share of the slower rear wheel less (1 + q)/2 [1]."""
    found = _shares(driven, road_wheel_angle=ANGLE)
    return found.slower - (1 + _rear_difference(driven)) / 2


def error_of_the_faster(driven: ScenarioRuns) -> float:
    """Share of the faster rear wheel less (1 - q)/2 [1]."""
    found = _shares(driven, road_wheel_angle=ANGLE)
    return found.faster - (1 - _rear_difference(driven)) / 2


def sum_of_the_rear(driven: ScenarioRuns) -> float:
    """Sum of both shares [1]."""
    found = _shares(driven, road_wheel_angle=ANGLE)
    return found.slower + found.faster
