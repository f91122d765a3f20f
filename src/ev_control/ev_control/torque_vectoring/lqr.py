"""Yaw rate and sideslip by a linear quadratic regulator, scheduled by speed.

Esmailzadeh, Goodarzi & Vossoughi (2003), Optimal yaw moment control law for improved vehicle
handling, Mechatronics 13(7), 659-675: the single-track model with the yaw moment as its only input.
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

from ev_control.torque_vectoring.single_track import SingleTrackParameters, single_track
from ev_core.law import Vehicle, compilable, parameter

SPEED_STEP = 2.5  # [m/s]
SPEEDS = 32  # of the schedule, each way
_DOUBLINGS = 14  # of the horizon: 2^14 periods are for ever
_Matrix = tuple[float, float, float, float]  # row by row


@dataclass(frozen=True, slots=True)
class LQRParameters:
    """Weights by Bryson's rule: what counts as much as what; the source leaves them open."""

    yaw_rate_error: float = parameter(
        0.05,
        unit="rad/s",
        low=1e-4,
        high=10.0,
        about="error of the yaw rate that counts as much as `moment`",
    )
    sideslip_error: float = parameter(
        0.05,
        unit="rad",
        low=1e-4,
        high=10.0,
        about="error of the sideslip that counts as much as `moment`",
    )
    moment: float = parameter(
        1500.0, unit="N m", low=1.0, high=1e6, about="yaw moment that counts as much"
    )


class Gains(NamedTuple):
    """Yaw moment over errors at 0, SPEED_STEP, 2 SPEED_STEP ... ahead, and behind them in reverse.

    With them the cost of errors from here on, P of the Riccati equation.
    """

    lateral: tuple[float, ...]  # [N s]
    yaw: tuple[float, ...]  # [N m s/rad]
    cost_lateral: tuple[float, ...]  # [s^2/m^2]
    cost_both: tuple[float, ...]  # [s^2/(m rad)]
    cost_yaw: tuple[float, ...]  # [s^2/rad^2]


@lru_cache(1024)  # cars: each search of a board has the same draws again
def lqr_gains(
    p: LQRParameters, tyres: SingleTrackParameters, vehicle: Vehicle, period: float
) -> Gains:
    """Gains that make the weighed squares least on an endless horizon, by implicit Euler steps."""
    ahead = [SPEED_STEP * n for n in range(SPEEDS)]
    reverse = [-speed for speed in ahead]
    rows = [_gains_at(p, tyres, vehicle, period, speed) for speed in (*ahead, *reverse)]
    return Gains(*zip(*rows, strict=True))


def _gains_at(
    p: LQRParameters, tyres: SingleTrackParameters, vehicle: Vehicle, period: float, speed: float
) -> tuple[float, float, float, float, float]:
    """Gains (R + B'PB)^-1 B'PA and P at a speed [m/s], P by doubling (Chu et al. 2004)."""
    model = single_track(tyres, vehicle, speed)
    a = _inverse(
        (
            1.0 - period * model.a_11,
            -period * model.a_12,
            -period * model.a_21,
            1.0 - period * model.a_22,
        )
    )
    b = (a[1] * period / vehicle.yaw_inertia, a[3] * period / vehicle.yaw_inertia)
    effort = 1.0 / (p.moment * p.moment)
    aside = p.sideslip_error * max(abs(speed), tyres.slowest)
    cost = (1.0 / (aside * aside), 0.0, 0.0, 1.0 / (p.yaw_rate_error * p.yaw_rate_error))
    # A, G and H of the doubling algorithm: `closed`, `reach` and `cost`.
    closed = a
    reach = (b[0] * b[0] / effort, b[0] * b[1] / effort, b[1] * b[0] / effort, b[1] * b[1] / effort)
    # Each round doubles the horizon behind which the errors no longer cost anything.
    for _ in range(_DOUBLINGS):
        once = _inverse(_sum((1.0, 0.0, 0.0, 1.0), _product(reach, cost)))
        turned = _transposed(closed)
        cost_more = _product(_product(turned, _product(cost, once)), closed)
        reach_more = _product(_product(closed, _product(once, reach)), turned)
        closed = _product(_product(closed, once), closed)
        cost, reach = _sum(cost, cost_more), _sum(reach, reach_more)
    weighed = (b[0] * cost[0] + b[1] * cost[2], b[0] * cost[1] + b[1] * cost[3])
    share = effort + weighed[0] * b[0] + weighed[1] * b[1]
    return (
        (weighed[0] * a[0] + weighed[1] * a[2]) / share,
        (weighed[0] * a[1] + weighed[1] * a[3]) / share,
        cost[0],
        (cost[1] + cost[2]) / 2.0,
        cost[3],
    )


# Sums and products in one order, because BLAS rounds them as the processor has it.
def _product(x: _Matrix, y: _Matrix) -> _Matrix:
    return (
        x[0] * y[0] + x[1] * y[2],
        x[0] * y[1] + x[1] * y[3],
        x[2] * y[0] + x[3] * y[2],
        x[2] * y[1] + x[3] * y[3],
    )


def _sum(x: _Matrix, y: _Matrix) -> _Matrix:
    return x[0] + y[0], x[1] + y[1], x[2] + y[2], x[3] + y[3]


def _transposed(x: _Matrix) -> _Matrix:
    return x[0], x[2], x[1], x[3]


def _inverse(x: _Matrix) -> _Matrix:
    determinant = x[0] * x[3] - x[1] * x[2]
    return x[3] / determinant, -x[1] / determinant, -x[2] / determinant, x[0] / determinant


NO_GAINS = Gains(*[(0.0,) * (2 * SPEEDS)] * len(Gains._fields))


@compilable
def lqr_moment(gains: Gains, speed: float, lateral_error: float, yaw_error: float) -> float:
    """M_z = -k_v (v - v*) - k_r (r - r*) [N m], by errors in m/s and rad/s."""
    return -at_speed(gains.lateral, speed) * lateral_error - at_speed(gains.yaw, speed) * yaw_error


@compilable
def at_speed(row: tuple[float, ...], speed: float) -> float:
    """A row of the schedule, interpolated at a speed [m/s], constant beyond the last."""
    # Rows of reverse lie behind those of ahead, each with rising magnitudes.
    place = min(abs(speed) / SPEED_STEP, SPEEDS - 1.0)
    below = min(int(place), SPEEDS - 2)
    first = below if speed >= 0.0 else SPEEDS + below
    return row[first] + (place - below) * (row[first + 1] - row[first])
