"""A target slip by the road under the rear wheels: that of the fitted peak, once a wheel has passed it."""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.estimation.first_order_filter import start_again
from ev_control.estimation.slip_peak import SlipPeakParameters, SlipPeakState, peak_is_passed, watch_slip
from ev_core.law import Car, WheelStates, compilable, entry, group, parameter, part

TARGETS = ("fixed", "fitted")
FIXED, FITTED = range(len(TARGETS))


@dataclass(frozen=True, slots=True)
class RoadTargetParameters:
    """Where the target slip comes from, how the peak is fitted, and how far the target keeps below it."""

    target: str = parameter(
        "fixed",
        choices=TARGETS,
        about="fixed: the given slip; fitted: at most the share of the peak that least squares have found",
        source="Ge & Ni 2005: by the road conditions in fig. 2, a fixed cautious value in the runs",
    )
    share: float = parameter(
        0.95,
        unit="1",
        low=0.1,
        high=1.0,
        about="target slip over the slip of the fitted peak",
        source="Ge & Ni 2005: 0.19 on a road with its peak at 0.2",
    )
    peak: SlipPeakParameters = group(SlipPeakParameters)


@dataclass(slots=True)
class WatchedWheel:
    """What lasts of a wheel between steps."""

    curve: SlipPeakState = part(SlipPeakState)
    speed: float = entry(unit="rad/s", about="last wheel speed")
    watched: float = entry(unit="1", about="1 if there is a last wheel speed")


@dataclass(slots=True)
class RoadTargetState:
    """What lasts between steps."""

    left: WatchedWheel = part(WatchedWheel)
    right: WatchedWheel = part(WatchedWheel)
    lowest: float = entry(1.0, unit="1", about="target by the lowest peak that a wheel has passed so far")


forget_road = start_again(RoadTargetState)


@compilable
def target_by_road(
    p: RoadTargetParameters,
    car: Car,
    s: RoadTargetState,
    period: float,
    wheels: WheelStates,
    slip_left: float,
    slip_right: float,
    given: float,
) -> float:
    """The target slip [1] of rear wheels with these slips [1]: `given`, or what the road allows if that is less.

    It only falls: below the peak nothing tells that the road has become better.
    """
    if p.target == FIXED:
        return given
    watch(p, car, s, s.left, 2, period, slip_left, wheels.velocity.rear_left, wheels.effort.rear_left)
    watch(p, car, s, s.right, 3, period, slip_right, wheels.velocity.rear_right, wheels.effort.rear_right)
    return min(given, s.lowest)


@compilable
def watch(
    p: RoadTargetParameters,
    car: Car,
    s: RoadTargetState,
    w: WatchedWheel,
    place: int,
    period: float,
    slip: float,
    speed: float,
    torque: float,
) -> None:
    """Take one more sample of a wheel: slip [1], speed [rad/s] and mean torque over the period [N m].

    `place` is that of the wheel in the order of Wheels. y = A x + B sqrt(x + e) is fitted to slip and road torque
    M - J w' as in the traction control `least_squares` (dissertation, eqs 2.34 to 2.36).
    """
    if w.watched == 1.0:
        road = torque - car.driven_wheel_inertia[place] * (speed - w.speed) / period
        watch_slip(p.peak, w.curve, period, slip, road / (car.motor.nominal_torque * car.gear_ratio))
        if peak_is_passed(p.peak, w.curve, p.peak.speed_noise / max(abs(speed), p.peak.slowest)):
            s.lowest = min(s.lowest, max(p.share * w.curve.peak, p.peak.least_slip))
    w.speed, w.watched = speed, 1.0
