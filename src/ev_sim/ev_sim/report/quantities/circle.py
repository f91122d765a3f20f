"""How far a path is from a circle."""

from __future__ import annotations

import numpy as np

from ev_sim.report.metric import NotMeasured
from ev_sim.report.samples import channel
from ev_sim.running.recording.recording import Recording


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
