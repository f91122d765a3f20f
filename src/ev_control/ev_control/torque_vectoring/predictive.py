"""Yaw rate and sideslip by linear model-predictive control: the regulator of `lqr` that knows where the moment ends.

Bemporad, Morari, Dua & Pistikopoulos (2002), The explicit linear quadratic regulator for constrained systems,
Automatica 38: a finite horizon with the cost of the endless one behind it, solved at each step (`active_set`). With yaw
moment and wheel torques of electric cars: Jalali et al. (2016), Integrated stability and traction control for electric
vehicles using model predictive control, Control Engineering Practice 54.
"""

from dataclasses import dataclass

from ev_control.torque_vectoring.active_set import SIZE, Program, solve
from ev_control.torque_vectoring.lqr import Gains, LQRParameters, at_speed
from ev_control.torque_vectoring.single_track import SingleTrack
from ev_core.law import Car, compilable, memory_type, part, series, working_memory


@dataclass(slots=True)
class Horizon:
    """Working memory: what one moment does after 1, 2, 3 ... periods, and the program of all moments."""

    lateral: list[float] = series(SIZE, unit="m/s")
    yaw: list[float] = series(SIZE, unit="rad/s")
    program: Program = part(Program)


_HORIZON = memory_type(Horizon)


@compilable
def predictive_moment(
    p: LQRParameters,
    car: Car,
    gains: Gains,
    model: SingleTrack,
    period: float,
    speed: float,
    slowest: float,
    lateral_error: float,
    yaw_error: float,
    ahead: float,
    most: float,
) -> float:
    """The first of SIZE moments [N m] that make the weighed squares of errors and moments least.

    Errors of lateral velocity [m/s] and yaw rate [rad/s] follow the single-track model; sideslip counts at a speed of
    at least `slowest` [m/s]. The moments and what is fed `ahead` stay together within +-`most` [N m]. Where they do by
    themselves it is the moment of the regulator.
    """
    w = working_memory(_HORIZON)[0]
    # Implicit Euler, as the gains are made: x+ = A (x + T (0, M/J)), with moments in the unit of their weight.
    a, b, c, d = 1.0 - period * model.a_11, -period * model.a_12, -period * model.a_21, 1.0 - period * model.a_22
    determinant = a * d - b * c
    a, b, c, d = d / determinant, -b / determinant, -c / determinant, a / determinant
    v, r = lateral_error, yaw_error
    pushed = period * p.moment / car.yaw_inertia
    w.lateral[0], w.yaw[0] = b * pushed, d * pushed
    for k in range(1, SIZE):
        w.lateral[k] = a * w.lateral[k - 1] + b * w.yaw[k - 1]
        w.yaw[k] = c * w.lateral[k - 1] + d * w.yaw[k - 1]
    aside = p.sideslip_error * max(abs(speed), slowest)
    for k in range(SIZE):
        v, r = a * v + b * r, c * v + d * r
        q_v, q_both, q_r = 1.0 / (aside * aside), 0.0, 1.0 / (p.yaw_rate_error * p.yaw_rate_error)
        if k == SIZE - 1:
            q_v, q_both = at_speed(gains.cost_lateral, speed), at_speed(gains.cost_both, speed)
            q_r = at_speed(gains.cost_yaw, speed)
        for i in range(k + 1):
            by_v = q_v * w.lateral[k - i] + q_both * w.yaw[k - i]
            by_r = q_both * w.lateral[k - i] + q_r * w.yaw[k - i]
            w.program.slope[i] += by_v * v + by_r * r
            for j in range(i + 1):
                w.program.hessian[i * SIZE + j] += by_v * w.lateral[k - j] + by_r * w.yaw[k - j]
    for i in range(SIZE):
        w.program.hessian[i * SIZE + i] += 1.0
        w.program.low[i], w.program.high[i] = (-most - ahead) / p.moment, (most - ahead) / p.moment
    solve(w.program)
    first: float = p.moment * w.program.x[0]
    return first
