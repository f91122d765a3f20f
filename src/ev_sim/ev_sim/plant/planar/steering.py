"""From the mean road-wheel angle to the angles of the two front wheels."""

from __future__ import annotations

from math import sqrt, tan

from ev_sim.compiled import compiled


@compiled
def front_wheels(angle: float, wheelbase: float, track: float, parallel: float) -> tuple[float, float, float, float]:
    """Cosine and sine of the left, cosine and sine of the right front wheel's angle.

    Mean angle delta [rad], left positive; Ackermann geometry unless `parallel` is 1. Written with tan(delta) in the
    numerator, so that straight ahead needs no case of its own. Source: Shchur 2019, eq. 8.
    """
    t = tan(angle)
    outward = t * (0.5 * track) * (1.0 - parallel)
    left = wheelbase * t / (wheelbase - outward)
    right = wheelbase * t / (wheelbase + outward)
    cos_left = 1.0 / sqrt(1.0 + left * left)
    cos_right = 1.0 / sqrt(1.0 + right * right)
    return cos_left, left * cos_left, cos_right, right * cos_right
