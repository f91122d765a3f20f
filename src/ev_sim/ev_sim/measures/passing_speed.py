"""Quantities of a run when the car passes a speed in its bend, so that runs compare at equal speed."""

from __future__ import annotations

import numpy as np

from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_sim.measures import handling, motion
from ev_sim.measures.metric import NotMeasured
from ev_sim.measures.samples import channel
from ev_sim.recording.recording import Recording


def turning_in(run: Recording) -> int:
    """The first sample with turned front wheels; NotMeasured if there is none."""
    return motion.first(channel(run, motion.ROAD_WHEEL_ANGLE) != 0.0, "steering")


def when_passing(run: Recording, speed: float, values: np.ndarray) -> float:
    """The value of (n,) at the instant at which the run passes a speed [m/s] after turning in."""
    start, actual = turning_in(run), motion.path_speed(run)
    if actual[start] >= speed:
        raise NotMeasured(f"the car is faster than {speed:g} m/s before the bend")
    time = motion.crossing_time(run.time[start:], actual[start:], speed, f"{speed:g} m/s")
    return motion.value_at(run, values, time)


def total_force(run: Recording) -> np.ndarray:
    """Sum of the magnitudes of the four tyre forces in the plane of the road, (n,) [N]."""
    along, across = (
        [channel(run, f"tire_forces.{kind}_force.{wheel}") for wheel in WHEEL_NAMES]
        for kind in ("longitudinal", "lateral")
    )
    return np.hypot(along, across).sum(axis=0)


def energy_since_turning_in(run: Recording) -> np.ndarray:
    """Work of the drives at the wheels since the front wheels are turned, (n,) [J]."""
    work = handling.drive_work(run)
    return work - work[turning_in(run)]


def time_since_turning_in(run: Recording) -> np.ndarray:
    """Time since the front wheels are turned, (n,) [s]."""
    return run.time - run.time[turning_in(run)]
