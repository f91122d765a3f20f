"""Wheel torques by weighted least squares within what motors can give and tyres can hold.

The least sum of the squared use of grip, (M_i/(r mu F_z))^2, that gives drive torque and yaw
moment: Mokhiamar & Abe (2004), Simultaneous optimal distribution of lateral and longitudinal tire
forces for the model following control, J. Dyn. Syst. Meas. Control 126; both demands as weighted
errors, wheels at their bounds as the active set: Harkegard (2002), Efficient active set algorithms
for solving constrained least squares problems in aircraft control allocation.
"""

from dataclasses import dataclass
from typing import NamedTuple

from ev_control.shared.allocation import Range, motor_range
from ev_control.torque_vectoring.known_motion import KnownMotion
from ev_core.law import Car, Wheels, compilable, copysign, parameter, sqrt

LEAST_GRIP = 1.0  # [N m]; a lifted wheel has none
ROUNDS = 30  # of Newton's steps
CLOSE = 1e-20  # [1], gain of the dual function that a step no longer promises


@dataclass(frozen=True, slots=True)
class LeastSquaresParameters:
    """Weights of the demands, and share of a tyre that may be used."""

    weight: float = parameter(
        1e4,
        unit="1",
        low=1.0,
        high=1e8,
        about="of both demands over that of the use of grip, as shares of all grip",
    )
    moment_weight: float = parameter(
        10.0,
        unit="1",
        low=1e-3,
        high=1e3,
        about="of the yaw moment over that of the drive torque, where both do not fit",
        source="assumption: a car that turns as wanted before one that keeps its speed",
    )
    grip_share: float = parameter(
        0.95,
        unit="1",
        low=0.1,
        high=1.0,
        about="share of the friction ellipse that a wheel may use",
    )
    least: float = parameter(
        0.5,
        unit="1",
        low=0.0,
        high=1.0,
        about="share of its grip that a wheel may use along however it slides aside; with little "
        "of it no moment is left for a car at its limit",
    )


class Demand(NamedTuple):
    """Least of sum (u/g)^2/2 + (sum u - T)^2/(2 e_t) + (sum b u - M)^2/(2 e_m) over torques u."""

    total: float  # T [N m]
    moment: float  # M [N m]
    total_slack: float  # e_t [N^2 m^2]
    moment_slack: float  # e_m [N^2 m^2]
    grip: Wheels  # g, torque at which a tyre slides [N m]
    arm: Wheels  # b, yaw moment of a torque [1]
    least: Wheels  # torques that a wheel can get [N m]
    most: Wheels


@compilable
def least_squares(
    p: LeastSquaresParameters, car: Car, motion: KnownMotion, total: float, moment: float
) -> Wheels:
    """Torques of the driven wheels [N m] for a drive torque and a yaw moment [N m]."""
    grip = sliding_torques(car, motion)
    a = wheel_range(p, car, motion, grip, 0)
    b = wheel_range(p, car, motion, grip, 1)
    c = wheel_range(p, car, motion, grip, 2)
    d = wheel_range(p, car, motion, grip, 3)
    # One arm for both axles: with two of them wheels of a side would fight where both demands do
    # not fit.
    arm = (car.front_track + car.rear_track) / (4.0 * car.wheel_radius)
    whole = (grip[0] + grip[1]) + (grip[2] + grip[3])
    lever = whole * arm
    demand = Demand(
        total,
        moment,
        whole * whole / p.weight,
        lever * lever / (p.weight * p.moment_weight),
        grip,
        Wheels(-arm, arm, -arm, arm),
        Wheels(a.least, b.least, c.least, d.least),
        Wheels(a.most, b.most, c.most, d.most),
    )
    return bounded_least_squares(demand)


@compilable
def sliding_torques(car: Car, motion: KnownMotion) -> Wheels:
    """The torques at which tyres slide without a side force [N m]."""
    r = car.wheel_radius
    return Wheels(
        max(motion.grip[0] * r, LEAST_GRIP),
        max(motion.grip[1] * r, LEAST_GRIP),
        max(motion.grip[2] * r, LEAST_GRIP),
        max(motion.grip[3] * r, LEAST_GRIP),
    )


@compilable
def wheel_range(
    p: LeastSquaresParameters, car: Car, motion: KnownMotion, grip: Wheels, wheel: int
) -> Range:
    """Torques [N m] that the motor of a wheel gives and its tyre holds beside the side force.

    |M| <= g sqrt(share^2 - (F_y/(mu F_z))^2), but `least` of g at least.
    """
    aside = motion.side_force[wheel] * car.wheel_radius / grip[wheel]
    along = grip[wheel] * max(sqrt(max(p.grip_share * p.grip_share - aside * aside, 0.0)), p.least)
    motor = motor_range(car, wheel, motion.wheel_speed[wheel])
    return Range(max(motor.least, -along), min(motor.most, along))


class Multipliers(NamedTuple):
    """Cost of an N m more of each demand, or a step of both [1/(N m)]."""

    total: float
    moment: float


class Slope(NamedTuple):
    """Gradient of the dual function, and its curvature by the wheels that are within bounds."""

    total: float
    moment: float
    of_total: float
    of_both: float
    of_moment: float


@compilable
def bounded_least_squares(demand: Demand) -> Wheels:
    """The torques that are optimal within their ranges [N m].

    The two demands leave a dual problem in two multipliers: where u_i = -g_i^2 (l_t + b_i l_m), cut
    to its range, meets both. It is concave, and quadratic as long as the same wheels are at their
    bounds, so that Newton's steps, each as far as the function rises, end at the optimum of the
    last such set. All sums take left and right first: a mirrored car gets mirrored torques to the
    bit.
    """
    at = Multipliers(0.0, 0.0)
    for _ in range(ROUNDS):
        here = slope(demand, at)
        # Two unknowns: the system of Newton is solved by hand.
        determinant = here.of_total * here.of_moment - here.of_both * here.of_both
        step = Multipliers(
            (here.of_moment * here.total - here.of_both * here.moment) / determinant,
            (here.of_total * here.moment - here.of_both * here.total) / determinant,
        )
        # What the step promises is below rounding: done.
        if step.total * here.total + step.moment * here.moment <= CLOSE:
            break
        at = moved(at, step, summit(demand, at, step))
    return torques(demand, at)


@compilable
def summit(demand: Demand, at: Multipliers, step: Multipliers) -> float:
    """The part of a step up to which the dual function rises, at most all of it [1].

    Its rise falls linearly between the places where a wheel comes to a bound or leaves it, so that
    two of them that enclose its zero give it exactly.
    """
    low, high = 0.0, 1.0
    low_rise = rise(demand, at, step, low)
    high_rise = rise(demand, at, step, high)
    if high_rise >= 0.0:
        return high
    for i in range(4):
        squared, arm = demand.grip[i] * demand.grip[i], demand.arm[i]
        change = -squared * (step.total + arm * step.moment)
        free = -squared * (at.total + arm * at.moment)
        for n in range(2):
            gap = (demand.most[i] if n == 1 else demand.least[i]) - free
            # The wheel comes to this bound within the step.
            if low * abs(change) < copysign(gap, gap * change) < high * abs(change):
                place = gap / change
                there = rise(demand, at, step, place)
                if there >= 0.0:
                    low = place
                    low_rise = there
                else:
                    high = place
                    high_rise = there
    return low + (high - low) * low_rise / (low_rise - high_rise)


@compilable
def rise(demand: Demand, at: Multipliers, step: Multipliers, place: float) -> float:
    """Rise of the dual function at a place of a step [1]."""
    there = slope(demand, moved(at, step, place))
    return step.total * there.total + step.moment * there.moment


@compilable
def moved(at: Multipliers, step: Multipliers, place: float) -> Multipliers:
    """The multipliers at a place of a step [1]."""
    return Multipliers(at.total + place * step.total, at.moment + place * step.moment)


@compilable
def torques(demand: Demand, at: Multipliers) -> Wheels:
    """The best torques at some multipliers [N m]."""
    return Wheels(
        torque(demand, at, 0), torque(demand, at, 1), torque(demand, at, 2), torque(demand, at, 3)
    )


@compilable
def torque(demand: Demand, at: Multipliers, wheel: int) -> float:
    """The best torque of a wheel [N m]."""
    free = -demand.grip[wheel] * demand.grip[wheel] * (at.total + demand.arm[wheel] * at.moment)
    return min(max(free, demand.least[wheel]), demand.most[wheel])


@compilable
def slope(demand: Demand, at: Multipliers) -> Slope:
    """Both demands, as far as they are not met, and how they change with the multipliers."""
    u, arm = torques(demand, at), demand.arm
    w = bend(demand, u, 0)
    x = bend(demand, u, 1)
    y = bend(demand, u, 2)
    z = bend(demand, u, 3)
    had = (u[0] + u[1]) + (u[2] + u[3])
    turned = (arm[0] * u[0] + arm[1] * u[1]) + (arm[2] * u[2] + arm[3] * u[3])
    squared = (arm[0] * arm[0] * w + arm[1] * arm[1] * x) + (
        arm[2] * arm[2] * y + arm[3] * arm[3] * z
    )
    return Slope(
        had - demand.total - demand.total_slack * at.total,
        turned - demand.moment - demand.moment_slack * at.moment,
        (w + x) + (y + z) + demand.total_slack,
        (arm[0] * w + arm[1] * x) + (arm[2] * y + arm[3] * z),
        squared + demand.moment_slack,
    )


@compilable
def bend(demand: Demand, torque: Wheels, wheel: int) -> float:
    """Change of a torque with the multipliers [N^2 m^2]: g^2 within its bounds, at them zero."""
    within = demand.least[wheel] < torque[wheel] < demand.most[wheel]
    return demand.grip[wheel] * demand.grip[wheel] if within else 0.0
