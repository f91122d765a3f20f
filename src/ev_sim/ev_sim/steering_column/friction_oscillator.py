"""Inertia, spring, damper, dry friction and end stops under a torque that is held over the period.

The equation J x'' + b x' + k x = T - M_c sgn(x') is linear as long as the direction of motion does not change.
So each phase of motion is integrated exactly, and the instants that end a phase (reversal, end stop) are solved
for instead of stepped over: rest is rest, without chatter or creep, at any period.
"""

from __future__ import annotations

import math

# Halvings of a bracket after which the instant of an impact is known to the last bit of a double.
_HALVINGS = 54


class FrictionOscillator:
    """Exact steps of J x'' + b x' + k x = T - M_c sgn(x') within |x| <= stop.

    In SI units, the angle x in rad: `inertia` J > 0 [kg m^2], `damping` b >= 0 [N m s/rad], `stiffness` k > 0
    [N m/rad], `dry_friction` M_c >= 0 [N m], `stop` > 0 [rad], `period` [s]. The object is constant; angle and rate
    belong to the caller. Its equation is eq 3 of Shchur (2019). The end stops take all kinetic energy (plastic impact).
    """

    def __init__(
        self, inertia: float, damping: float, stiffness: float, dry_friction: float, stop: float, period: float
    ) -> None:
        self._inertia, self._k = inertia, stiffness
        self._friction, self._stop, self._period = dry_friction, stop, period
        # Eigenvalues -decay +- split, split imaginary if the free motion oscillates. At exactly critical damping the
        # two are told apart by a part in 10^8, which changes the motion by a part in 10^16.
        self._decay = damping / (2 * inertia)
        discriminant = self._decay**2 - stiffness / inertia
        self._oscillates = discriminant < 0.0
        self._split = math.sqrt(abs(discriminant)) or 1e-8 * self._decay
        self._full_period = self._transition(period)

    def advance(self, angle: float, rate: float, torque: float) -> tuple[float, float]:
        """Angle and rate after one period under a constant torque [N m]."""
        remaining = self._period
        while True:
            direction = self._direction(angle, rate, torque)
            if direction == 0.0:
                return angle, 0.0
            equilibrium = (torque - direction * self._friction) / self._k
            reversal = self._time_to_reversal(abs(rate), direction * (equilibrium - angle))
            duration = min(remaining, reversal)
            next_angle, next_rate = self._move(angle, rate, equilibrium, duration)
            if direction * next_angle > self._stop:
                duration = self._time_to_stop(angle, rate, equilibrium, direction, duration)
                next_angle, next_rate = direction * self._stop, 0.0
            elif duration == reversal or direction * next_rate < 0.0:  # a rate against the phase is rounding
                next_rate = 0.0
            remaining -= duration
            if remaining <= 0.0:
                return next_angle, next_rate
            angle, rate = next_angle, next_rate

    def _direction(self, angle: float, rate: float, torque: float) -> float:
        """+1 or -1 for the phase of motion that begins, 0 for rest: held by dry friction or by a stop."""
        if rate != 0.0:
            return math.copysign(1.0, rate)
        free_torque = torque - self._k * angle
        if abs(free_torque) <= self._friction:
            return 0.0
        direction = math.copysign(1.0, free_torque)
        return 0.0 if direction * angle >= self._stop else direction

    def _time_to_reversal(self, speed: float, lead: float) -> float:
        """When a motion with this speed (>= 0), its equilibrium this far ahead, comes to rest; infinite if never [s].

        The speed is e^(-decay t) (speed C(t) + slope S(t)) with the C and S of `_transition`.
        """
        slope = lead * self._k / self._inertia - self._decay * speed
        split = self._split
        if self._oscillates:
            return math.atan2(speed * split, -slope) / split
        if speed * split < -slope:
            return math.atanh(speed * split / -slope) / split
        return math.inf

    def _time_to_stop(self, angle: float, rate: float, equilibrium: float, direction: float, before: float) -> float:
        """When the motion reaches the stop, known to lie within `before`; the angle is monotone until then [s]."""
        low, high = 0.0, before
        for _ in range(_HALVINGS):
            middle = (low + high) / 2
            if direction * self._move(angle, rate, equilibrium, middle)[0] > self._stop:
                high = middle
            else:
                low = middle
        return high

    def _move(self, angle: float, rate: float, equilibrium: float, duration: float) -> tuple[float, float]:
        """Angle and rate after a duration within one phase of motion."""
        full = duration == self._period
        p11, p12, p21, p22 = self._full_period if full else self._transition(duration)
        deflection = angle - equilibrium
        return equilibrium + p11 * deflection + p12 * rate, p21 * deflection + p22 * rate

    def _transition(self, t: float) -> tuple[float, float, float, float]:
        """Elements of the transition matrix exp(A t) of deflection and rate, row by row."""
        if self._oscillates:
            envelope = math.exp(-self._decay * t)
            c = envelope * math.cos(self._split * t)
            s = envelope * math.sin(self._split * t) / self._split
        else:
            # The slow eigenvalue from the product of both: their difference would cancel in a stiff system.
            slow = math.exp(-self._k / self._inertia / (self._decay + self._split) * t)
            c = slow * (1 + math.exp(-2 * self._split * t)) / 2
            s = slow * -math.expm1(-2 * self._split * t) / (2 * self._split)
        return c + self._decay * s, s, -self._k / self._inertia * s, c - self._decay * s
