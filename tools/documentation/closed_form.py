"""The step response of an underdamped second-order system in closed form (Shchur 2019, eq 7), for pages and tests."""

from __future__ import annotations

import math

from scipy.optimize import brentq

from ev_papers.shchur2019.paper import SecondOrder


def peak_time(system: SecondOrder) -> float:
    """Time from the step to the first peak, half of the period [s]."""
    return math.pi / system.damped_frequency


def extreme(system: SecondOrder, number: int) -> float:
    """Size of the n-th extreme of the deviation as a fraction of the final value; the 0th is the step itself."""
    return math.exp(-system.decay * number * peak_time(system))


def overshoot(system: SecondOrder) -> float:
    """First peak beyond the steady angle [% of it]."""
    return 100 * extreme(system, 1)


def settling_time(system: SecondOrder, band: float) -> float:
    """Time from the step to the last entry into +-band around the final value [s]."""
    swing = next(n for n in range(1000) if extreme(system, n + 1) <= band)
    # The deviation falls monotonically from this extreme, the last outside the band, to the next
    # one.
    outside, inside = swing * peak_time(system), (swing + 1) * peak_time(system)
    edge = math.copysign(band, system.deviation(outside))
    return float(brentq(lambda time: system.deviation(time) - edge, outside, inside, xtol=1e-12))
