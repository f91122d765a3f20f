"""Inertia, spring, damper, dry friction and end stops under a torque that is held over the period.

The equation J x'' + b x' + k x = T - M_c sgn(x'), eq 3 of Shchur (2019), is linear as long as the
direction of motion does not change. So each phase of motion is integrated exactly, and the instants
that end a phase (reversal, end stop) are solved for instead of stepped over: rest is rest, without
chatter or creep, at any period.
"""

from __future__ import annotations

import math
from typing import NamedTuple

from ev_core.law import atan2, atanh, compilable, copysign, cos, exp, expm1, sin, sqrt

# Halvings of a bracket after which the instant of an impact is known to the last bit of a double.
_HALVINGS = 54


class Transition(NamedTuple):
    """The transition matrix exp(A t) of deflection and rate, row by row."""

    p11: float
    p12: float
    p21: float
    p22: float


class FreeMotion(NamedTuple):
    """Eigenvalues -decay +- split [1/s] of J x'' + b x' + k x = 0.

    The split is imaginary if it oscillates (1, else 0).
    """

    inertia: float
    stiffness: float
    decay: float
    split: float
    oscillates: float


class Oscillator(NamedTuple):
    """Oscillator J x'' + b x' + k x = T - M_c sgn(x') within |x| <= stop.

    The stops take all kinetic energy (plastic impact). In SI units, the angle x in rad.
    `full_period` is the transition over the whole period [s].
    """

    dry_friction: float
    stop: float
    period: float
    free: FreeMotion
    full_period: Transition


def oscillator(
    inertia: float,
    damping: float,
    stiffness: float,
    dry_friction: float,
    stop: float,
    period: float,
) -> Oscillator:
    """Oscillator with J > 0 [kg m^2], b >= 0 [N m s/rad], k > 0 [N m/rad].

    M_c >= 0 [N m], and the stop > 0 [rad]. At exactly critical damping the eigenvalues are set
    apart by a part in 10^8, which changes the motion by a part in 10^16.
    """
    decay = damping / (2 * inertia)
    discriminant = decay * decay - stiffness / inertia
    # sin(w t)/w and sinh(w t)/w would be 0/0.
    split = sqrt(abs(discriminant)) or 1e-8 * decay
    free = FreeMotion(inertia, stiffness, decay, split, float(discriminant < 0.0))
    return Oscillator(dry_friction, stop, period, free, transition(free, period))


@compilable
def oscillated(o: Oscillator, angle: float, rate: float, torque: float) -> tuple[float, float]:
    """Angle [rad] and rate [rad/s] after one period under a constant torque [N m]."""
    remaining = o.period
    while True:
        direction = _direction(o, angle, rate, torque)
        if direction == 0.0:
            return angle, 0.0
        # While the direction lasts dry friction is a constant torque: it only shifts the
        # equilibrium.
        equilibrium = (torque - direction * o.dry_friction) / o.free.stiffness
        reversal = _time_to_reversal(o.free, abs(rate), direction * (equilibrium - angle))
        duration = min(remaining, reversal)
        next_angle, next_rate = _move(o, angle, rate, equilibrium, duration)
        # The end of the phase is beyond the stop, and the motion towards it is monotone: the impact
        # is within.
        if direction * next_angle > o.stop:
            duration = _time_to_stop(o, angle, rate, equilibrium, direction, duration)
            next_angle, next_rate = direction * o.stop, 0.0
        elif duration == reversal or direction * next_rate < 0.0:
            # A phase ends at rest; a rate against it is rounding.
            next_rate = 0.0
        remaining -= duration
        if remaining <= 0.0:
            return next_angle, next_rate
        angle, rate = next_angle, next_rate


@compilable
def _direction(o: Oscillator, angle: float, rate: float, torque: float) -> float:
    """Sign of the motion that begins, 0 for rest: held by dry friction or by a stop."""
    if rate != 0.0:
        return copysign(1.0, rate)
    free_torque = torque - o.free.stiffness * angle
    if abs(free_torque) <= o.dry_friction:
        return 0.0
    direction = copysign(1.0, free_torque)
    if direction * angle >= o.stop:
        return 0.0
    # Where the torque is as good as the friction, rounding may put the equilibrium where the motion
    # begins, or behind.
    ahead = (torque - direction * o.dry_friction) / o.free.stiffness - angle
    return direction if direction * ahead > 0.0 else 0.0


@compilable
def _time_to_reversal(free: FreeMotion, speed: float, lead: float) -> float:
    """Time at which a motion comes to rest, infinite if never [s].

    Its speed is at least 0, its equilibrium so far ahead. The speed is e^(-decay t) (speed C(t) +
    slope S(t)) with the C and S of `transition`.
    """
    # The rate is zero where speed C + slope S = 0, that is tan(split t) = -speed split/slope; tanh
    # where nothing oscillates, which has no root unless the speed is small enough.
    slope = lead * free.stiffness / free.inertia - free.decay * speed
    split = free.split
    if free.oscillates == 1.0:
        # From rest this is half a period of the oscillation.
        return atan2(speed * split, -slope) / split
    if speed * split < -slope:
        return atanh(speed * split / -slope) / split
    return math.inf


@compilable
def _time_to_stop(
    o: Oscillator, angle: float, rate: float, equilibrium: float, direction: float, before: float
) -> float:
    """Time at which the motion reaches the stop, which lies within `before` [s].

    The angle is monotone until then.
    """
    low, high = 0.0, before
    for _ in range(_HALVINGS):
        middle = (low + high) / 2
        if direction * _move(o, angle, rate, equilibrium, middle)[0] > o.stop:
            high = middle
        else:
            low = middle
    return high


@compilable
def _move(
    o: Oscillator, angle: float, rate: float, equilibrium: float, duration: float
) -> tuple[float, float]:
    """Angle and rate after a duration within one phase of motion."""
    full = duration == o.period
    p11, p12, p21, p22 = o.full_period if full else transition(o.free, duration)
    deflection = angle - equilibrium
    return equilibrium + p11 * deflection + p12 * rate, p21 * deflection + p22 * rate


@compilable
def transition(free: FreeMotion, t: float) -> Transition:
    """The transition matrix of the free motion over the time t [s]."""
    if free.oscillates == 1.0:
        envelope = exp(-free.decay * t)
        c = envelope * cos(free.split * t)
        s = envelope * sin(free.split * t) / free.split
    else:
        # The slow eigenvalue from the product of both: their difference would cancel in a stiff
        # system.
        slow = exp(-free.stiffness / free.inertia / (free.decay + free.split) * t)
        c = slow * (1 + exp(-2 * free.split * t)) / 2
        s = slow * -expm1(-2 * free.split * t) / (2 * free.split)
    return Transition(c + free.decay * s, s, -free.stiffness / free.inertia * s, c - free.decay * s)
