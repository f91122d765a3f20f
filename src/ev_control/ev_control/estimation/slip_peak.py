"""Peak of the slip curve that a wheel has passed, and a target slip below it.

How it works: `watch_slip` takes each sample into the window of a fit, and `peak_is_passed` is true
once the fitted curve has fallen at the slip for some steps in a row. A traction control makes a
target of that peak; `most_by_road` makes a bound of the targets of rear wheels.
"""

from dataclasses import dataclass
from enum import auto
from math import inf
from typing import NamedTuple

from ev_control.estimation import slip_curve_fit
from ev_control.estimation.wheel_dynamics import slowest_wheel, start_again
from ev_core.law import Car, Choice, WheelStates, compilable, entry, group, parameter, part

FEWEST_SAMPLES = 8  # four for each coefficient


class Target(Choice):
    """Sources of the target slip."""

    FIXED = auto()
    FITTED = auto()


@dataclass(frozen=True, slots=True)
class SlipPeakParameters(slip_curve_fit.SlipCurveParameters):
    """The window of the fit, and when it counts; the source gives none of them."""

    window: float = parameter(
        0.125,
        unit="s",
        low=0.01,
        high=2.0,
        about="of the fit; less than 0.05 s misses peaks, more than 0.25 s is late",
    )
    slowest: float = slowest_wheel()
    offset: float = parameter(
        1e-4,
        unit="1",
        low=1e-9,
        high=0.1,
        about="added to the slip under the root, so that its slope at zero is finite",
    )
    least_slip: float = parameter(
        0.03,
        unit="1",
        low=0.0,
        high=0.5,
        about="slip below which nothing is a hit, and the least that is regulated to",
    )
    speed_noise: float = parameter(
        0.03,
        unit="rad/s",
        low=1e-4,
        high=10.0,
        about="standard deviation of measured wheel speeds, no reason to fit",
    )
    spread: float = parameter(
        3.0,
        unit="1",
        low=0.0,
        high=100.0,
        about="least standard deviation of the slip in a fit, over that of noise",
    )
    hits: int = parameter(
        5, unit="1", low=1, high=100, about="steps in a row in which the curve falls, for a hit"
    )


@dataclass(slots=True)
class SlipPeakState:
    """State of the search for the peak."""

    fit: slip_curve_fit.SlipCurveFit = part(slip_curve_fit.SlipCurveFit)
    slip: float = entry(unit="1", about="last slip")
    falling: float = entry(unit="1", about="steps in a row in which the curve falls")
    peak: float = entry(unit="1", about="slip of the peak at the last hit")


@compilable
def watch_slip(
    p: SlipPeakParameters, s: SlipPeakState, period: float, slip: float, torque: float
) -> None:
    """Take the slip at the end of a period [1], and the mean torque of the road [1] in it.

    The torque goes with the mean slip of the period: then the noise of the speeds, which is in
    both, does not tilt the curve.
    """
    samples = float(max(round(p.window / period), FEWEST_SAMPLES))
    slip_curve_fit.add_sample(s.fit, samples, p.offset, (slip + s.slip) / 2.0, torque, p.template)
    s.slip = slip


@compilable
def peak_is_passed(p: SlipPeakParameters, s: SlipPeakState, noise: float) -> bool:
    """Return true if the fitted curve has fallen at the slip for long enough; keep its peak.

    A fit counts if the slip spreads more than its noise [1] explains, and exceeds both `least_slip`
    and the window's mean.
    """
    least_spread = p.spread * noise
    counts = (
        s.slip > p.least_slip
        and slip_curve_fit.is_full(s.fit)
        and s.slip > slip_curve_fit.mean_slip(s.fit)
    )
    # What spreads no more than noise has no slope.
    if not counts or slip_curve_fit.slip_variance(s.fit) <= least_spread * least_spread:
        s.falling = 0.0
        return False
    peak = slip_curve_fit.fitted_peak(p, s.fit)
    # A peak below the present slip: there the curve falls.
    s.falling = s.falling + 1.0 if peak <= s.slip else 0.0
    if peak > s.slip or s.falling < p.hits:
        return False
    s.falling = 0.0
    s.peak = peak
    return True


@dataclass(frozen=True, slots=True)
class RoadTargetParameters:
    """Source of the target slip, fit of the peak, and distance of the target below it."""

    target: Target = parameter(
        Target.FIXED,
        about="fixed: the given slip; fitted: at most the share of the peak that least squares "
        "have found",
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
    """State of a wheel."""

    curve: SlipPeakState = part(SlipPeakState)
    speed: float = entry(unit="rad/s", about="last wheel speed")
    watched: bool = entry(False, unit="1", about="whether there is a last wheel speed")


class RearSlips(NamedTuple):
    """Slips of the rear wheels [1]."""

    left: float
    right: float


class WheelSample(NamedTuple):
    """Measurements of a wheel in a step."""

    place: int  # in the order of Wheels
    slip: float  # [1]
    speed: float  # [rad/s]
    torque: float  # mean over the period [N m]


@dataclass(slots=True)
class RoadTargetState:
    """State of both rear wheels, and the target that their roads allow."""

    left: WatchedWheel = part(WatchedWheel)
    right: WatchedWheel = part(WatchedWheel)
    lowest: float = entry(
        1.0, unit="1", about="target by the lowest peak that a wheel has passed so far"
    )


forget_road = start_again(RoadTargetState)


@compilable
def most_by_road(
    p: RoadTargetParameters,
    car: Car,
    s: RoadTargetState,
    period: float,
    wheels: WheelStates,
    slips: RearSlips,
) -> float:
    """Largest target slip [1] of rear wheels that the road allows; infinite for a fixed target.

    It only falls: below the peak nothing shows that the road has become better.
    """
    if p.target == Target.FIXED:
        return inf
    speed, torque = wheels.velocity, wheels.effort
    left = WheelSample(2, slips.left, speed.rear_left, torque.rear_left)
    right = WheelSample(3, slips.right, speed.rear_right, torque.rear_right)
    watch(p, car, s, s.left, period, left)
    watch(p, car, s, s.right, period, right)
    return s.lowest


@compilable
def watch(
    p: RoadTargetParameters,
    car: Car,
    s: RoadTargetState,
    w: WatchedWheel,
    period: float,
    sample: WheelSample,
) -> None:
    """Take one more sample of a wheel.

    y = A x + B sqrt(x + e) is fitted to slip and road torque M - J w' as in the traction control
    `least_squares` (dissertation, eqs 2.34 to 2.36).
    """
    if w.watched:
        inertia = car.driven_wheel_inertia[sample.place]
        road = sample.torque - inertia * (sample.speed - w.speed) / period
        nominal = car.motor.nominal_torque * car.gear_ratio
        watch_slip(p.peak, w.curve, period, sample.slip, road / nominal)
        noise = p.peak.speed_noise / max(abs(sample.speed), p.peak.slowest)
        if peak_is_passed(p.peak, w.curve, noise):
            s.lowest = min(s.lowest, max(p.share * w.curve.peak, p.peak.least_slip))
    w.speed = sample.speed
    w.watched = True
