"""Shares of the drive torque that a law asks for, how calm they are, and the thresholds that the source's words need.

M. M. Zhileykin, A. V. Eranosyan, "Improvement of four-wheel drive vehicle controllability with a connected front axle
through the redistribution of torque" (in Russian), Bauman University, 2018.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ev_sim.measures.metric import NotMeasured, channel
from ev_sim.recording.recording import Recording

LIMIT = math.radians(15.0)  # sideslip angle beyond which the rear axle has slid out [rad]; assumed, the source has none
SWING = 0.005  # [1], least way of a share between two turn-arounds; assumed: what moves less is no oscillation
CALM = 1  # turn-arounds of one share that entering the bend explains
NOMINAL = "k1"  # the run whose law has the factor 1 of its proportionalities


def deviation_from_circle(run: Recording, begin: float) -> float:
    """Largest distance of the path of the centre of mass after `begin` [s] from the circle that fits it best [m].

    The circle is that of least squares in x^2 + y^2 = 2 a x + 2 b y + c. NotMeasured if the car stands still.
    """
    later = run.time >= begin
    x, y = channel(run, "pose.x")[later], channel(run, "pose.y")[later]
    if len(x) < 3 or np.ptp(x) + np.ptp(y) < 1.0:
        raise NotMeasured("the car does not move")
    x, y = x - x.mean(), y - y.mean()
    (a, b, c), *_ = np.linalg.lstsq(np.column_stack((2 * x, 2 * y, np.ones_like(x))), x**2 + y**2, rcond=None)
    return float(np.abs(np.hypot(x - a, y - b) - np.sqrt(c + a**2 + b**2)).max())


def off_the_path(run: Recording, x: Sequence[float], y: Sequence[float]) -> float:
    """Largest distance of the centre of mass from a path of straight legs between points [m]."""
    points, at = np.column_stack((x, y)), np.column_stack((channel(run, "pose.x"), channel(run, "pose.y")))
    leg = np.diff(points, axis=0)
    along = np.einsum("nkd,kd->nk", at[:, None] - points[:-1], leg) / (leg**2).sum(axis=1)
    nearest = points[:-1] + np.clip(along, 0.0, 1.0)[..., None] * leg
    return float(np.linalg.norm(at[:, None] - nearest, axis=2).min(axis=1).max())


def front_share(run: Recording) -> np.ndarray:
    """Torque of the front axle over that of the car, h_n, (n,) [1]."""
    front = _asked(run, "front_left") + _asked(run, "front_right")
    return front / (front + _asked(run, "rear_left") + _asked(run, "rear_right"))


def rear_left_share(run: Recording) -> np.ndarray:
    """Torque of the left rear wheel over that of its axle, h_2, (n,) [1]."""
    return _asked(run, "rear_left") / (_asked(run, "rear_left") + _asked(run, "rear_right"))


def rear_right_share(run: Recording) -> np.ndarray:
    """The same of the right one, h_4, (n,) [1]."""
    return _asked(run, "rear_right") / (_asked(run, "rear_left") + _asked(run, "rear_right"))


SHARES = {"h_n": front_share, "h_2": rear_left_share, "h_4": rear_right_share}


def _asked(run: Recording, wheel: str) -> np.ndarray:
    return channel(run, f"torque_request.drive.{wheel}")


def turn_arounds(values: np.ndarray, swing: float) -> int:
    """How often a series turns around after a way of more than `swing`, in its unit."""
    count, direction = 0, 0
    low = high = values[0]
    for value in values:
        low, high = min(low, value), max(high, value)
        if direction >= 0 and value < high - swing:
            count, direction, low = count + (direction > 0), -1, value
        elif direction <= 0 and value > low + swing:
            count, direction, high = count + (direction < 0), 1, value
    return count
