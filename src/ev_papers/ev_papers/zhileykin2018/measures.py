"""What Zhileykin (2018) is judged by: its inputs, rear drive and the 4x4 into a bend on ice, and eqs 4, 5 and 7.

The source has one run whose drive force and steering angle it does not give. So each claim is judged on the run of the
scenario and, since a single run proves nothing, on the cases of the sweep: it has to hold in most of them. The law is
that with the factor K = 1 of its proportionalities; what other factors, and no law at all, do stands beside it.

Each public function measures one number of published.csv, on the runs or on the sweep.
"""

from __future__ import annotations

import dataclasses
import math
from typing import NamedTuple

import numpy as np

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
from ev_msgs_py.contract.wheels import NO_WHEELS, WHEEL_NAMES, Wheels
from ev_papers.zhileykin2018 import grid
from ev_papers.zhileykin2018.grid import LIMIT, NOMINAL, REAR_DRIVE, SHARES, SWING
from ev_stack.measures import motion
from ev_stack.measures.metric import NotMeasured, channel, run_named
from ev_stack.measures.motion import ROAD_WHEEL_ANGLE, moving
from ev_study.analysis.linear_models import SideSlipModel, side_slip_model
from ev_study.verdicts.need import ScenarioRuns, StudyCases

STEERED = 3.0  # [s], the end of the third second, in which the steering wheel is turned


def _front_shares(driven: ScenarioRuns) -> np.ndarray:
    """Front shares of all runs in which the law shares out the torque."""
    return np.concatenate([grid.front_share(run_named(driven.runs, name)) for name in grid.BY_LAW])


def largest_front_share(driven: ScenarioRuns) -> float:
    """The largest front share [1]."""
    return _front_shares(driven).max()


def front_share_is_never_negative(driven: ScenarioRuns) -> bool:
    """Whether no front share is below zero."""
    return bool(_front_shares(driven).min() >= 0.0)


def largest_slip_angle(driven: ScenarioRuns, run: str) -> float:
    """Largest slip angle of any wheel [rad]."""
    return float(np.abs(_slip_angles(driven, run)).max())


def _slip_angles(driven: ScenarioRuns, run: str) -> np.ndarray:
    return np.array(
        [
            channel(run_named(driven.runs, run), f"tire_forces.slip_angle.{wheel}")
            for wheel in WHEEL_NAMES
        ]
    )


def sides_apart(driven: ScenarioRuns, run: str) -> float:
    """Largest difference of the slip angles left and right over the largest slip angle [1]."""
    angles = _slip_angles(driven, run)
    if not (largest := np.abs(angles).max()):
        raise NotMeasured("no wheel has a slip angle")
    return float(np.abs(angles[::2] - angles[1::2]).max() / largest)


def off_the_circle(driven: ScenarioRuns, run: str) -> float:
    """Largest distance of the path from a circle once the steering is held [m]."""
    return grid.deviation_from_circle(run_named(driven.runs, run), STEERED)


def off_the_path(driven: ScenarioRuns, run: str) -> float:
    """Largest distance of the car from the path that its driver follows [m]."""
    driver = driven.parameters["driver"]
    return grid.off_the_path(run_named(driven.runs, run), driver["path.x"], driver["path.y"])


def rear_slides_out(driven: ScenarioRuns) -> bool:
    """Whether the rear axle has the larger slip angle where rear drive passes the limit: it, not the front, slides."""
    run, vehicle = run_named(driven.runs, REAR_DRIVE), driven.vehicle
    n = motion.first(
        moving(run) & (np.abs(motion.sideslip_angle(run)) >= LIMIT), "a sideslip angle of 15 deg"
    )
    u, v, r, delta = (
        channel(run, name)[n]
        for name in ("twist.longitudinal", "twist.lateral", "twist.yaw_rate", ROAD_WHEEL_ANGLE)
    )
    rear_arm = vehicle.centre_of_mass_to_rear_axle
    front = delta - math.atan2(v + (vehicle.wheelbase - rear_arm) * r, u)
    rear = -math.atan2(v - rear_arm * r, u)
    return bool(abs(rear) > abs(front))


def turn_arounds(driven: ScenarioRuns, share: str) -> float:
    """How often a share of the torque turns around."""
    return grid.turn_arounds(SHARES[share](run_named(driven.runs, NOMINAL)), SWING)


def cases(sweep: StudyCases) -> int:
    """How many cases the sweep has for each control."""
    return grid.SIZE


def spinning_cases(sweep: StudyCases) -> int:
    """In how many of them rear drive spins."""
    return int(grid.spins(sweep.results).sum())


def held_cases(sweep: StudyCases, control: str) -> int:
    """In how many of the cases in which rear drive spins a control holds."""
    return int((grid.holds(sweep.results, control) & grid.spins(sweep.results)).sum())


def calm_cases(sweep: StudyCases, control: str, share: str) -> int:
    """In how many cases a share of the torque is calm with a control."""
    return int(grid.is_calm(sweep.results, control, share).sum())


def share_that_spins(sweep: StudyCases) -> float:
    """Share of the cases in which rear drive spins [1]."""
    return spinning_cases(sweep) / grid.SIZE


def share_held(sweep: StudyCases) -> float:
    """Share of those that the law holds [1]."""
    return held_cases(sweep, NOMINAL) / max(spinning_cases(sweep), 1)


def calm_share(sweep: StudyCases, share: str) -> float:
    """Share of the cases in which a share of the torque is calm with the law [1]."""
    return calm_cases(sweep, NOMINAL, share) / grid.SIZE


def held_more(sweep: StudyCases) -> float:
    """How many cases more than rear drive the law holds."""
    return float(
        grid.holds(sweep.results, NOMINAL).sum() - grid.holds(sweep.results, REAR_DRIVE).sum()
    )


FORCE = 3000.0  # X, that the driver asks for [N]
_ROLE = "electronic_differential"
_SPEED = 8.0  # [m/s]


class _Shares(NamedTuple):
    """Of the front axle in the torque of the car, and of the rear wheels in that of their axle [1]."""

    front: float
    slower: float
    faster: float


def _shares(
    driven: ScenarioRuns,
    acceleration: float,
    phi: float = 0.0,
    road_wheel_angle: float = 0.0,
    **readings: object,
) -> _Shares:
    """What the law asks for at an acceleration [m/s^2] at an angle phi to the car's axis [rad] and a road-wheel angle.

    Car and parameters are those that were driven, but for the `readings`. The left rear wheel is the slower one, and
    the car has no slip angle that would choose a branch.
    """
    method, vehicle = find_method(_ROLE, "axle_redistribution"), driven.vehicle
    known = flatten(method.parameters())
    given = {
        name: value for name, value in driven.parameters.get(_ROLE, {}).items() if name in known
    }
    law = create(method, build(method.parameters, {**given, **readings}), vehicle, 0.01)
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
    return _Shares(front / (front + rear), drive.rear_left / rear, drive.rear_right / rear)


_SPEED = 8.0  # V [m/s]
_ACCELERATION = 1.0  # j [m/s^2]
_ANGLE = 0.1  # Theta [rad]
_OBLIQUE = math.acos(0.8)  # phi at which eq 5 and the line above it differ [rad]


def _model(driven: ScenarioRuns, acceleration: float, front_share: float) -> SideSlipModel:
    return side_slip_model(driven.vehicle, _SPEED, acceleration, FORCE, front_share)


def excitation_by_eq_4(driven: ScenarioRuns) -> float:
    """N of W12 [1/s] with the front share of eq 4 as an equality."""
    found = _shares(driven, _ACCELERATION, factor="equality")
    return _model(driven, _ACCELERATION, found.front).excitation


def excitation_by_eq_5(driven: ScenarioRuns) -> float:
    """N of W12 [1/s] with the front share of eq 5 as printed, where the line above it makes N zero."""
    found = _shares(driven, _ACCELERATION, _OBLIQUE, factor="equality", first_branch="rear")
    return _model(driven, _ACCELERATION * math.cos(_OBLIQUE), found.front).excitation


def excitation_by_eq_7(driven: ScenarioRuns) -> float:
    """N of W12 [1/s] with the shares of the rear wheels of eq 7, at constant speed and w_z = V Theta/L."""
    found = _shares(driven, _ACCELERATION, road_wheel_angle=_ANGLE)
    model = _model(driven, 0.0, found.front)
    yaw_rate = _SPEED * _ANGLE / driven.vehicle.wheelbase
    return dataclasses.replace(
        model, rear_difference=found.slower - found.faster, yaw_rate=yaw_rate
    ).excitation


def front_share(driven: ScenarioRuns, angle: float, branch: str) -> float:
    """Front share [1] at an angle phi, in multiples of pi, by the equation of a branch.

    By itself, without the rule on slowing down, which comes before it where j_x <= 0.
    """
    return _shares(
        driven, _ACCELERATION, angle * math.pi, first_branch=branch, braking="command"
    ).front


def front_share_when_slowing_down(driven: ScenarioRuns) -> float:
    """Front share [1] at phi = pi, with that rule."""
    return _shares(driven, _ACCELERATION, math.pi, first_branch="rear").front


def _rear(driven: ScenarioRuns) -> tuple[float, float, float]:
    """Shares of the slower and the faster rear wheel, and q, their difference by eq 7 at a front share of a half."""
    found, vehicle = _shares(driven, _ACCELERATION, road_wheel_angle=_ANGLE), driven.vehicle
    return found.slower, found.faster, vehicle.wheelbase * _ANGLE / (2 * vehicle.rear_track)


def error_of_the_slower(driven: ScenarioRuns) -> float:
    """How far the share of the slower rear wheel lies above (1 + q)/2 [1]."""
    slower, _, q = _rear(driven)
    return slower - (1 + q) / 2


def error_of_the_faster(driven: ScenarioRuns) -> float:
    """How far the share of the faster rear wheel lies above (1 - q)/2 [1]."""
    _, faster, q = _rear(driven)
    return faster - (1 - q) / 2


def sum_of_the_rear(driven: ScenarioRuns) -> float:
    """The sum of both shares [1]."""
    return sum(_rear(driven)[:2])
