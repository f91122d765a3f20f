"""Slip of a wheel: against the reference speed, or from its own torque and speed (dissertation, eqs 1.8 to 1.10)."""

from __future__ import annotations

from dataclasses import dataclass, field

from ev_control.asr.traction_control import WheelMotion
from ev_control.asr.wheel_dynamics import mass_share
from ev_control.first_order_filter import Filtered, filter_share
from ev_msgs_py.parameters import parameter
from ev_msgs_py.vehicle import Vehicle


@dataclass(frozen=True, slots=True)
class SlipObserverParameters:
    """Which observer, and what the source leaves open about them."""

    observer: str = parameter(
        "reference_speed",
        choices=("reference_speed", "derivative", "corrected_derivative", "disturbance"),
        about="reference_speed: none, eq 2.34; derivative: eq 1.8; corrected_derivative: eq 1.9; disturbance: eq 1.10",
        source="dissertation, eqs 1.8 to 1.10",
    )
    slowest: float = parameter(
        3.0,
        unit="rad/s",
        low=0.1,
        high=100.0,
        about="wheel speed below which slip is counted against this speed, so that rest is no slip",
        source="assumption",
    )
    correction: float = parameter(
        1.0,
        unit="1",
        low=0.0,
        high=1.0,
        about="corrected_derivative: share of the measured in the acceleration of the car, k(lambda) r w",
        source="assumption; k(lambda) is not given",
    )
    filter_time: float = parameter(
        0.05, unit="s", low=0.0, high=1.0, about="disturbance: time constant of torque and acceleration",
        source="assumption",
    )  # fmt: skip
    least_acceleration: float = parameter(
        3.0,
        unit="rad/s^2",
        low=0.1,
        high=1000.0,
        about="disturbance: wheel acceleration below which eq 1.10, which divides by it, says nothing",
        source="assumption",
    )
    forget_time: float = parameter(
        0.3,
        unit="s",
        low=0.0,
        high=100.0,
        about="disturbance: time constant of forgetting the slip where eq 1.10 says nothing",
        source="assumption",
    )


@dataclass(slots=True)
class SlipObserverState:
    """Estimated slip [1], filtered torque [N m] and acceleration [rad/s^2]."""

    slip: float = 0.0
    torque: Filtered = field(default_factory=Filtered)
    acceleration: Filtered = field(default_factory=Filtered)


class SlipObserver:
    """Estimate the slip of one wheel; M is the mass that the wheel moves, J the inertia behind it.

    - `derivative` integrates l' = -(w'/w) l + (1 + J/(r^2 M)) w'/w - T/(r^2 M w) (eq 1.8). It knows nothing but its
      own wheel: resistance and a wheel on the other side that pulls less count as acceleration of the car that is not
      there, and what is wrong once stays.
    - `corrected_derivative` adds k (V'_calculated - V'_measured) (eq 1.9) with V'_calculated = (T - J w')/(r M). With
      k = 1/(r w) all of the acceleration is the measured one, and only the error of the beginning stays.
    - `disturbance` takes l = -d/(r^2 M w') with the torque d = T - (J + r^2 M) w' that a wheel which grips would leave
      unexplained (eq 1.10, printed with l' on the left, but a slip stands on the right). It holds for a steady slip,
      says nothing where w' passes zero or the wheel is slower than `slowest`; there the slip is slowly forgotten, else
      a control that has taken all torque from a wheel would wait for ever.

    All start from no slip when the torque sets in, and stay within 0..1. Below `slowest` [rad/s] the equations are
    those of the slip that is counted against this speed.
    """

    def __init__(self, parameters: SlipObserverParameters, vehicle: Vehicle, period: float) -> None:
        self._p = parameters
        self._period = period
        self._inertia, self._radius = vehicle.driven_wheel_inertia, vehicle.wheel_radius
        self._mass = mass_share(vehicle)
        self._carried = self._radius**2 * self._mass
        self._share = filter_share(period, parameters.filter_time)
        self._forgotten = filter_share(period, parameters.forget_time)

    def slip(self, state: SlipObserverState, motion: WheelMotion) -> float:
        """The slip [1] at the end of this period."""
        kind = self._p.observer
        if kind == "reference_speed":
            return motion.slip(self._p.slowest)
        slip = self._disturbance(state, motion) if kind == "disturbance" else self._derivative(state, motion)
        state.slip = min(max(slip, 0.0), 1.0)
        return state.slip

    def _derivative(self, state: SlipObserverState, motion: WheelMotion) -> float:
        """The integrated slip of eqs 1.8 and 1.9 [1]."""
        p, turning = self._p, motion.acceleration
        against = max(abs(motion.speed), p.slowest)
        growing = turning if motion.speed > p.slowest else 0.0  # the divisor w, as far as it changes
        rate = (turning + self._inertia / self._carried * turning - motion.torque / self._carried) / against
        rate -= growing / against * state.slip
        if p.observer == "corrected_derivative":
            calculated = (motion.torque - self._inertia * turning) / (self._radius * self._mass)
            rate += p.correction / (self._radius * against) * (calculated - motion.body_acceleration)
        return state.slip + rate * self._period

    def _disturbance(self, state: SlipObserverState, motion: WheelMotion) -> float:
        """The slip of eq 1.10 [1], or what is not yet forgotten of the last one."""
        torque = state.torque.follow(motion.torque, self._share)
        turning = state.acceleration.follow(motion.acceleration, self._share)
        if abs(turning) < self._p.least_acceleration or motion.speed < self._p.slowest:
            return state.slip * (1 - self._forgotten)
        disturbance = torque - (self._inertia + self._carried) * turning
        return -disturbance / (self._carried * turning)
