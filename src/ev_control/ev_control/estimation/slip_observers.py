"""Slip of a wheel against the reference speed, or by its torque (dissertation, eqs 1.8 to 1.10)."""

from dataclasses import dataclass
from enum import auto

from ev_control.estimation import wheel_dynamics
from ev_core.law import Car, Choice, compilable, entry, parameter, part


class Observer(Choice):
    """Equations by which slip is observed."""

    REFERENCE_SPEED = auto()
    DERIVATIVE = auto()
    CORRECTED_DERIVATIVE = auto()
    DISTURBANCE = auto()


@dataclass(frozen=True, slots=True)
class SlipObserverParameters:
    """Choice of the observer, and numbers that the source leaves open."""

    observer: Observer = parameter(
        Observer.REFERENCE_SPEED,
        about="reference_speed: none, eq 2.34; derivative: eq 1.8; corrected_derivative: eq 1.9; "
        "disturbance: eq 1.10",
        source="dissertation, eqs 1.8 to 1.10",
    )
    slowest: float = wheel_dynamics.slowest_wheel()
    correction: float = parameter(
        1.0,
        unit="1",
        low=0.0,
        high=1.0,
        about="corrected_derivative: share of the measured in the acceleration of the car, "
        "k(lambda) r w",
        source="assumption; k(lambda) is not given",
    )
    filter_time: float = parameter(
        0.05,
        unit="s",
        low=0.0,
        high=1.0,
        about="disturbance: time constant of torque and acceleration",
    )
    least_acceleration: float = parameter(
        3.0,
        unit="rad/s^2",
        low=0.1,
        high=1000.0,
        about="disturbance: acceleration below which eq 1.10 gives no slip",
    )
    forget_time: float = parameter(
        0.3,
        unit="s",
        low=0.0,
        high=100.0,
        about="disturbance: time constant of forgetting where eq 1.10 gives no slip",
    )


@dataclass(slots=True)
class SlipObserverState:
    """State of the slip observers."""

    slip: float = entry(unit="1", about="estimated slip")
    torque: wheel_dynamics.Filtered = part(wheel_dynamics.Filtered)  # [N m]
    acceleration: wheel_dynamics.Filtered = part(wheel_dynamics.Filtered)  # [rad/s^2]


@compilable
def observed_slip(
    p: SlipObserverParameters,
    car: Car,
    s: SlipObserverState,
    period: float,
    motion: wheel_dynamics.WheelMotion,
) -> float:
    """Slip [1] at the end of this period; M is the mass that the wheel moves, J its inertia.

    - `derivative` integrates l' = -(w'/w) l + (1 + J/(r^2 M)) w'/w - T/(r^2 M w) (eq 1.8). It knows
      nothing but its own wheel: resistance and a wheel on the other side that pulls less count as
      acceleration of the car that is not there, and what is wrong once stays.
    - `corrected_derivative` adds k (V'_calculated - V'_measured) (eq 1.9) with V'_calculated = (T -
      J w')/(r M). With k = 1/(r w) all of the acceleration is the measured one, and only the error
      of the beginning stays.
    - `disturbance` takes l = -d/(r^2 M w') with the torque d = T - (J + r^2 M) w' that a wheel
      which grips would leave unexplained (eq 1.10, printed with l' on the left, but a slip stands
      on the right). It holds for a steady slip, and not where w' passes zero or the wheel is slower
      than `slowest`; there the slip is slowly forgotten, else a control that has taken all torque
      from a wheel would wait for ever.

    All start from no slip when the torque sets in, and stay within 0..1. Below `slowest` [rad/s]
    the equations are those of the slip that is counted against this speed.
    """
    if p.observer == Observer.REFERENCE_SPEED:
        return wheel_dynamics.slip_of(motion, p.slowest)
    if p.observer == Observer.DISTURBANCE:
        slip = slip_by_disturbance(p, car, s, period, motion)
    else:
        slip = slip_by_derivative(p, car, s, period, motion)
    s.slip = min(max(slip, 0.0), 1.0)
    return s.slip


@compilable
def slip_by_derivative(
    p: SlipObserverParameters,
    car: Car,
    s: SlipObserverState,
    period: float,
    motion: wheel_dynamics.WheelMotion,
) -> float:
    """The integrated slip of eqs 1.8 and 1.9 [1]."""
    radius = car.wheel_radius
    mass = wheel_dynamics.mass_share(car)
    turning = motion.acceleration
    inertia = car.driven_wheel_inertia[motion.place]
    carried = radius * radius * mass
    against = max(abs(motion.speed), p.slowest)
    # Below `slowest` the divisor is constant.
    growing = turning if motion.speed > p.slowest else 0.0  # the divisor w, as far as it changes
    rate = (turning + inertia / carried * turning - motion.torque / carried) / against
    rate -= growing / against * s.slip
    if p.observer == Observer.CORRECTED_DERIVATIVE:
        calculated = (motion.torque - inertia * turning) / (radius * mass)
        rate += p.correction / (radius * against) * (calculated - motion.body_acceleration)
    return s.slip + rate * period


@compilable
def slip_by_disturbance(
    p: SlipObserverParameters,
    car: Car,
    s: SlipObserverState,
    period: float,
    motion: wheel_dynamics.WheelMotion,
) -> float:
    """Slip of eq 1.10 [1], or what is not yet forgotten of the last one."""
    share = wheel_dynamics.filter_share(period, p.filter_time)
    torque = wheel_dynamics.follow(s.torque, motion.torque, share)
    turning = wheel_dynamics.follow(s.acceleration, motion.acceleration, share)
    # The slip is over both, and near their zeros it is noise.
    if abs(turning) < p.least_acceleration or motion.speed < p.slowest:
        return s.slip * (1.0 - wheel_dynamics.filter_share(period, p.forget_time))
    carried = car.wheel_radius * car.wheel_radius * wheel_dynamics.mass_share(car)
    disturbance = torque - (car.driven_wheel_inertia[motion.place] + carried) * turning
    return -disturbance / (carried * turning)
