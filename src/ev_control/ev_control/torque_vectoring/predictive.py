"""Yaw rate and sideslip by linear model-predictive control, the regulator of `lqr` with bounds.

Bemporad, Morari, Dua & Pistikopoulos (2002), The explicit linear quadratic regulator for
constrained systems, Automatica 38: a finite horizon with the cost of the endless one behind it,
solved at each step (`active_set`). With yaw moment and wheel torques of electric cars: Jalali et
al. (2016), Integrated stability and traction control for electric vehicles using model predictive
control, Control Engineering Practice 54.
"""

from dataclasses import dataclass
from typing import NamedTuple

from ev_control.torque_vectoring.active_set import SIZE, Program, solve
from ev_control.torque_vectoring.lqr import Gains, LQRParameters, at_speed
from ev_control.torque_vectoring.single_track import SingleTrack
from ev_core.law import Car, compilable, memory_type, part, series, working_memory


@dataclass(slots=True)
class Horizon:
    """Working memory: effect of one moment after 1, 2, 3 ... periods, and the program of all."""

    lateral: list[float] = series(SIZE, unit="m/s")
    yaw: list[float] = series(SIZE, unit="rad/s")
    program: Program = part(Program)


_HORIZON = memory_type(Horizon)


class Errors(NamedTuple):
    """Errors of the motion at a speed of the car."""

    speed: float  # along the car [m/s]
    lateral: float  # of the lateral velocity [m/s]
    yaw: float  # of the yaw rate [rad/s]


class Bounds(NamedTuple):
    """Bounds of the moment, and the moment that is fed ahead within them [N m]."""

    ahead: float
    most: float


class Motion(NamedTuple):
    """Motion over one period, x+ = A x + b M, with moments M in the unit of their weight."""

    a_11: float
    a_12: float
    a_21: float
    a_22: float
    b_1: float
    b_2: float


class Weights(NamedTuple):
    """Weights of the squares of both errors and of their product, at the end of a period."""

    lateral: float
    both: float
    yaw: float


@compilable
def predictive_moment(
    p: LQRParameters, gains: Gains, motion: Motion, aside: float, errors: Errors, bounds: Bounds
) -> float:
    """First of SIZE moments [N m] that make the weighed squares of errors and moments least.

    The errors follow the `motion` of the single-track model. A lateral velocity `aside` [m/s]
    counts as much as the moment of the weights. The moments and what is fed ahead stay together
    within +-`most`. Where they do by themselves it is the moment of the regulator.
    """
    w = working_memory(_HORIZON)[0]
    # Response to one moment: what each later moment does is the same, later.
    w.lateral[0] = motion.b_1
    w.yaw[0] = motion.b_2
    for k in range(1, SIZE):
        w.lateral[k] = motion.a_11 * w.lateral[k - 1] + motion.a_12 * w.yaw[k - 1]
        w.yaw[k] = motion.a_21 * w.lateral[k - 1] + motion.a_22 * w.yaw[k - 1]
    v, r = errors.lateral, errors.yaw
    within = Weights(1.0 / (aside * aside), 0.0, 1.0 / (p.yaw_rate_error * p.yaw_rate_error))
    last = Weights(
        at_speed(gains.cost_lateral, errors.speed),
        at_speed(gains.cost_both, errors.speed),
        at_speed(gains.cost_yaw, errors.speed),
    )
    for k in range(SIZE):
        # Errors without any moment at the end of period k.
        v, r = motion.a_11 * v + motion.a_12 * r, motion.a_21 * v + motion.a_22 * r
        q = last if k == SIZE - 1 else within
        # The i-th moment has acted for k - i further periods by then; only the lower half is
        # filled.
        for i in range(k + 1):
            by_v = q.lateral * w.lateral[k - i] + q.both * w.yaw[k - i]
            by_r = q.both * w.lateral[k - i] + q.yaw * w.yaw[k - i]
            w.program.slope[i] += by_v * v + by_r * r
            for j in range(i + 1):
                add = by_v * w.lateral[k - j] + by_r * w.yaw[k - j]
                w.program.hessian[i * SIZE + j] += add
    for i in range(SIZE):
        # Weight of the moments themselves, in their own unit.
        w.program.hessian[i * SIZE + i] += 1.0
        w.program.low[i] = (-bounds.most - bounds.ahead) / p.moment
        w.program.high[i] = (bounds.most - bounds.ahead) / p.moment
    solve(w.program)
    first: float = p.moment * w.program.x[0]
    return first


@compilable
def motion_over(p: LQRParameters, car: Car, model: SingleTrack, period: float) -> Motion:
    """Motion over a period [s] by implicit Euler, as the gains are made.

    x+ = A (x + T (0, M/J)), with A the inverse of 1 - T times the matrix of the model.
    """
    a, b = 1.0 - period * model.a_11, -period * model.a_12
    c, d = -period * model.a_21, 1.0 - period * model.a_22
    determinant = a * d - b * c
    a_12, a_22 = -b / determinant, a / determinant
    pushed = period * p.moment / car.yaw_inertia
    return Motion(d / determinant, a_12, -c / determinant, a_22, a_12 * pushed, a_22 * pushed)
