"""Paths of the car: how far one is from a circle, and from the path that a driver follows."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ev_stack.measures.metric import NotMeasured, channel
from ev_stack.recording.recording import Recording


def deviation_from_circle(run: Recording, begin: float) -> float:
    """Largest distance of the path after `begin` [s] from the circle that fits it best [m].

    The circle is that of least squares in x^2 + y^2 = 2 a x + 2 b y + c. NotMeasured if the car
    stands still.
    """
    later = run.time >= begin
    x = channel(run, "pose.x")[later]
    y = channel(run, "pose.y")[later]
    if len(x) < 3 or np.ptp(x) + np.ptp(y) < 1.0:
        raise NotMeasured("the car does not move")
    # About its own middle, for far from the origin x^2 + y^2 would lose digits.
    x = x - x.mean()
    y = y - y.mean()
    columns = np.column_stack((2 * x, 2 * y, np.ones_like(x)))
    (a, b, c), *_ = np.linalg.lstsq(columns, x**2 + y**2, rcond=None)
    radius = np.sqrt(c + a**2 + b**2)
    return float(np.abs(np.hypot(x - a, y - b) - radius).max())


def off_the_path(run: Recording, x: Sequence[float], y: Sequence[float]) -> float:
    """Largest distance of the centre of mass from a path of straight legs between points [m]."""
    points = np.column_stack((x, y))
    at = np.column_stack((channel(run, "pose.x"), channel(run, "pose.y")))
    legs = np.diff(points, axis=0)
    from_leg_start = at[:, None] - points[:-1]
    # Where the car is along each leg, as a share of its length, (n, legs).
    along = np.einsum("nkd,kd->nk", from_leg_start, legs) / (legs**2).sum(axis=1)
    nearest = points[:-1] + np.clip(along, 0.0, 1.0)[..., None] * legs
    distance = np.linalg.norm(at[:, None] - nearest, axis=2)
    return float(distance.min(axis=1).max())
