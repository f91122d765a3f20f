"""Zhileykin (2018), eqs 4, 5 and 7: what the law asks for at an instant, and the linear model with these shares."""

from __future__ import annotations

import dataclasses
import math
from typing import NamedTuple

from ev_core.lockstep.finding import find_method
from ev_core.methods.register import create
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
from ev_papers.zhileykin2018.paper import NOMINAL
from ev_sim.analysis.linear_models import SideSlipModel, side_slip_model
from ev_sim.verdicts.check import Measure, Number, Tolerance, absolute
from ev_sim.verdicts.declaration import Declaration, judged
from ev_sim.verdicts.need import ScenarioNeed, ScenarioRuns

FORCE = 3000.0  # X, that the driver asks for [N]
_ROLE = "electronic_differential"
_SPEED = 8.0  # [m/s]


class Shares(NamedTuple):
    """Of the front axle in the torque of the car, and of the rear wheels in that of their axle [1]."""

    front: float
    slower: float
    faster: float


def shares(
    driven: ScenarioRuns, acceleration: float, phi: float = 0.0, road_wheel_angle: float = 0.0, **readings: object
) -> Shares:
    """What the law asks for at an acceleration [m/s^2] at an angle phi to the car's axis [rad] and a road-wheel angle.

    Car and parameters are those that were driven, but for the `readings`. The left rear wheel is the slower one, and
    the car has no slip angle that would choose a branch.
    """
    method, vehicle = find_method(_ROLE, "axle_redistribution"), driven.vehicle
    known = flatten(method.parameters())
    told = {name: value for name, value in driven.parameters.get(_ROLE, {}).items() if name in known}
    law = create(method, build(method.parameters, {**told, **readings}), vehicle, 0.01)
    signals = {
        type(signal): signal
        for signal in (
            DriverCommand(FORCE * vehicle.wheel_radius, 0.0, 0.0),
            SteeringColumnState(0.0, 0.0, 0.0, road_wheel_angle, 0.0),
            WheelStates(NO_WHEELS, Wheels(20.0, 20.0, 20.0, 21.0), NO_WHEELS),
            InertialMeasurement(0.0, acceleration * math.cos(phi), acceleration * math.sin(phi)),
            BodyVelocity(_SPEED, _SPEED * math.tan(road_wheel_angle / 2), 0.0),
        )
    }
    drive = law.step(*(signals[kind] for kind in method.reads)).drive
    front, rear = drive.front_left + drive.front_right, drive.rear_left + drive.rear_right
    return Shares(front / (front + rear), drive.rear_left / rear, drive.rear_right / rear)


LAW = ScenarioNeed("zhileykin2018", runs=(NOMINAL,))
SPEED = 8.0  # V [m/s]
ACCELERATION = 1.0  # j [m/s^2]
ANGLE = 0.1  # Theta [rad]
OBLIQUE = math.acos(0.8)  # phi at which eq 5 and the line above it differ [rad]
_ALGEBRA = absolute(1e-9, "algebra")
_EXACT = absolute(1e-15, "algebra; cos(pi/2) is not zero in the computer")


def _model(driven: ScenarioRuns, acceleration: float, front_share: float) -> SideSlipModel:
    return side_slip_model(driven.vehicle, SPEED, acceleration, FORCE, front_share)


def _by_eq_4(driven: ScenarioRuns) -> float:
    """N of W12 [1/s] with the front share of eq 4 as an equality."""
    found = shares(driven, ACCELERATION, factor="equality")
    return _model(driven, ACCELERATION, found.front).excitation


def _by_eq_5(driven: ScenarioRuns) -> float:
    """N of W12 [1/s] with the front share of eq 5 as printed, where the line above it makes N zero."""
    found = shares(driven, ACCELERATION, OBLIQUE, factor="equality", first_branch="rear")
    return _model(driven, ACCELERATION * math.cos(OBLIQUE), found.front).excitation


def _by_eq_7(driven: ScenarioRuns) -> float:
    """N of W12 [1/s] with the shares of the rear wheels of eq 7, at constant speed and w_z = V Theta/L."""
    found = shares(driven, ACCELERATION, road_wheel_angle=ANGLE)
    model = _model(driven, 0.0, found.front)
    yaw_rate = SPEED * ANGLE / driven.vehicle.wheelbase
    return dataclasses.replace(model, rear_difference=found.slower - found.faster, yaw_rate=yaw_rate).excitation


def _front_at(phi: float, branch: str) -> Measure:
    """The equation by itself, without the rule on slowing down, which comes before it where j_x <= 0."""
    return lambda driven: shares(driven, ACCELERATION, phi, first_branch=branch, braking="command").front


def _at(phi: float, name: str, value: float, branch: str, tolerance: Tolerance) -> Number:
    return Number("1", value, tolerance, _front_at(phi, branch), name)


def _q(driven: ScenarioRuns) -> float:
    """Difference of the shares that eq 7 prescribes at the front share of a half [1]."""
    vehicle = driven.vehicle
    return vehicle.wheelbase * ANGLE / (2 * vehicle.rear_track)


def _rear(driven: ScenarioRuns) -> tuple[float, float]:
    found = shares(driven, ACCELERATION, road_wheel_angle=ANGLE)
    return found.slower, found.faster


_HALF = "limited to a half of the torque"

DECLARATIONS: tuple[Declaration, ...] = (
    judged("zhil.eq4.neutral", LAW, Number("1/s", 0.0, _ALGEBRA, _by_eq_4)),
    judged(
        "zhil.eq4.values",
        LAW,
        _at(0.0, "0", 0.5, "front", _EXACT),
        _at(math.pi / 2, "pi/2", 0.0, "front", _EXACT),
        _at(math.pi, "pi", 0.0, "front", _EXACT),
        assumption=f"proportional read as equal, {_HALF}",
    ),
    judged(
        "zhil.eq5.values",
        LAW,
        _at(0.0, "0", 0.0, "rear", _EXACT),
        _at(math.pi / 2, "pi/2", 0.5, "rear", _EXACT),
        _at(math.pi, "pi", 0.5, "rear", _EXACT),
        assumption=f"proportional read as equal, {_HALF}; eq 5 by itself, without the rule on slowing down",
    ),
    judged("zhil.eq5.derivation", LAW, Number("1/s", 0.0, _ALGEBRA, _by_eq_5)),
    judged(
        "zhil.braking",
        LAW,
        Number("1", 0.0, _EXACT, lambda driven: shares(driven, ACCELERATION, math.pi, first_branch="rear").front),
    ),
    judged("zhil.eq7.neutral", LAW, Number("1/s", 0.0, _ALGEBRA, _by_eq_7)),
    judged(
        "zhil.eq7.shares",
        LAW,
        Number("1", 0.0, _EXACT, lambda driven: _rear(driven)[0] - (1 + _q(driven)) / 2, "error of the slower"),
        Number("1", 0.0, _EXACT, lambda driven: _rear(driven)[1] - (1 - _q(driven)) / 2, "error of the faster"),
        Number("1", 1.0, _EXACT, lambda driven: sum(_rear(driven)), "sum"),
    ),
)
