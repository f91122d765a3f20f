"""Measures of Zhileykin (2018): rear drive and the 4x4 into a bend on ice, and counts of the sweep.

The source has one run without its drive force and steering angle. So each claim is judged on the
run of the scenario and, since a single run proves nothing, on the cases of the sweep: it has to
hold in most of them. The law is that with the factor K = 1 of its proportionalities; other factors,
and no law at all, are shown as well.

Each public function measures one number of published.csv, on the runs or on the sweep.
"""

from __future__ import annotations

import math

import numpy as np

from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_papers.zhileykin2018 import grid, paths, shares
from ev_papers.zhileykin2018.grid import LIMIT, NOMINAL, REAR_DRIVE
from ev_stack.measures import motion
from ev_stack.measures.metric import NotMeasured, channel, run_named
from ev_study.verdicts.need import ScenarioRuns, StudyCases

STEERED = 3.0  # [s], the end of the third second, in which the steering wheel is turned


def _front_shares(driven: ScenarioRuns) -> np.ndarray:
    """Front shares of all runs in which the law shares out the torque."""
    return np.concatenate(
        [shares.front_share(run_named(driven.runs, name)) for name in grid.BY_LAW]
    )


def largest_front_share(driven: ScenarioRuns) -> float:
    """Largest front share [1]."""
    return _front_shares(driven).max()


def front_share_is_never_negative(driven: ScenarioRuns) -> bool:
    """True if no front share is below zero."""
    return bool(_front_shares(driven).min() >= 0.0)


def _slip_angles(driven: ScenarioRuns, run: str) -> np.ndarray:
    """Slip angles of the four wheels, (4, n) [rad]."""
    recording = run_named(driven.runs, run)
    names = (f"tire_forces.slip_angle.{wheel}" for wheel in WHEEL_NAMES)
    return np.array([channel(recording, name) for name in names])


def largest_slip_angle(driven: ScenarioRuns, run: str) -> float:
    """Largest slip angle of any wheel [rad]."""
    return float(np.abs(_slip_angles(driven, run)).max())


def sides_apart(driven: ScenarioRuns, run: str) -> float:
    """Largest difference of the slip angles left and right over the largest slip angle [1]."""
    angles = _slip_angles(driven, run)
    largest = np.abs(angles).max()
    if not largest:
        raise NotMeasured("no wheel has a slip angle")
    left, right = angles[::2], angles[1::2]
    return float(np.abs(left - right).max() / largest)


def off_the_circle(driven: ScenarioRuns, run: str) -> float:
    """Largest distance of the path from a circle once the steering is held [m]."""
    return paths.deviation_from_circle(run_named(driven.runs, run), STEERED)


def off_the_path(driven: ScenarioRuns, run: str) -> float:
    """Largest distance of the car from the path that its driver follows [m]."""
    driver = driven.parameters["driver"]
    return paths.off_the_path(run_named(driven.runs, run), driver["path.x"], driver["path.y"])


def rear_slides_out(driven: ScenarioRuns) -> bool:
    """True if the rear axle has the larger slip angle where rear drive passes the limit.

    Then it slides out, and not the front axle.
    """
    run, vehicle = run_named(driven.runs, REAR_DRIVE), driven.vehicle
    beyond = motion.moving(run) & (np.abs(motion.sideslip_angle(run)) >= LIMIT)
    at = motion.first(beyond, "a sideslip angle of 15 deg")
    u = channel(run, "twist.longitudinal")[at]
    v = channel(run, "twist.lateral")[at]
    yaw_rate = channel(run, "twist.yaw_rate")[at]
    delta = channel(run, motion.ROAD_WHEEL_ANGLE)[at]
    rear_arm = vehicle.centre_of_mass_to_rear_axle
    front_arm = vehicle.wheelbase - rear_arm
    front = delta - math.atan2(v + front_arm * yaw_rate, u)
    rear = -math.atan2(v - rear_arm * yaw_rate, u)
    return bool(abs(rear) > abs(front))


def turn_arounds(driven: ScenarioRuns, share: str) -> float:
    """Number of reversals of a share of the torque from the turn-in on."""
    return shares.reversals(run_named(driven.runs, NOMINAL), share)


def cases(sweep: StudyCases) -> int:
    """Number of cases that the sweep has for each control."""
    return grid.SIZE


def spinning_cases(sweep: StudyCases) -> int:
    """Number of cases in which rear drive spins."""
    return int(grid.spins(sweep.results).sum())


def held_cases(sweep: StudyCases, control: str) -> int:
    """Number of the cases in which rear drive spins and a control holds."""
    return int((grid.holds(sweep.results, control) & grid.spins(sweep.results)).sum())


def calm_cases(sweep: StudyCases, control: str, share: str) -> int:
    """Number of cases in which a share of the torque is calm with a control."""
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
    """Number of cases that the law holds more than rear drive."""
    by_law = grid.holds(sweep.results, NOMINAL).sum()
    by_rear_drive = grid.holds(sweep.results, REAR_DRIVE).sum()
    return float(by_law - by_rear_drive)
