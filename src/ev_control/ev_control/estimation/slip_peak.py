"""Whether a wheel has passed the peak of its slip curve (dissertation, eqs 2.34 to 2.36); a target slip below it."""

from dataclasses import dataclass

from ev_control.estimation import slip_curve_fit
from ev_control.estimation.wheel_dynamics import slowest_wheel, start_again
from ev_core.law import Car, WheelStates, compilable, entry, group, parameter, part

FEWEST_SAMPLES = 8  # four for each coefficient


@dataclass(frozen=True, slots=True)
class SlipPeakParameters(slip_curve_fit.SlipCurveParameters):
    """The window of the fit, and when it counts; the source gives none of them."""

    window: float = parameter(
        0.125, unit="s", low=0.01, high=2.0, about="of the fit; less than 0.05 s misses peaks, more than 0.25 s is late"
    )
    slowest: float = slowest_wheel()
    offset: float = parameter(
        1e-4, unit="1", low=1e-9, high=0.1, about="added to the slip under the root, whose slope at zero is finite then"
    )
    least_slip: float = parameter(
        0.03, unit="1", low=0.0, high=0.5, about="slip below which nothing is a hit, and the least that is regulated to"
    )
    speed_noise: float = parameter(
        0.03, unit="rad/s", low=1e-4, high=10.0, about="standard deviation of measured wheel speeds, no reason to fit"
    )
    spread: float = parameter(
        3.0, unit="1", low=0.0, high=100.0, about="least standard deviation of the slip in a fit, over that of noise"
    )
    hits: int = parameter(5, unit="1", low=1, high=100, about="steps in a row in which the curve falls, for a hit")


@dataclass(slots=True)
class SlipPeakState:
    """What lasts between steps."""

    fit: slip_curve_fit.SlipCurveFit = part(slip_curve_fit.SlipCurveFit)
    slip: float = entry(unit="1", about="last slip")
    falling: float = entry(unit="1", about="steps in a row in which the curve falls")
    peak: float = entry(unit="1", about="slip of the peak at the last hit")


@compilable
def watch_slip(p: SlipPeakParameters, s: SlipPeakState, period: float, slip: float, torque: float) -> None:
    """Take the slip at the end of a period [1], and the mean torque of the road in it over its nominal value [1].

    The torque goes with the mean slip of the period: then the noise of the speeds, which is in both, does not tilt the
    curve.
    """
    samples = float(max(round(p.window / period), FEWEST_SAMPLES))
    slip_curve_fit.add_sample(s.fit, samples, p.offset, (slip + s.slip) / 2.0, torque, p.template)
    s.slip = slip


@compilable
def peak_is_passed(p: SlipPeakParameters, s: SlipPeakState, noise: float) -> bool:
    """Whether the fitted curve falls at the present slip, for long enough; notes the slip of its peak.

    A fit counts if the slip spreads more than its noise [1] explains, and exceeds both `least_slip` and the window's
    mean.
    """
    least_spread = p.spread * noise
    counts = s.slip > p.least_slip and slip_curve_fit.is_full(s.fit) and s.slip > slip_curve_fit.mean_slip(s.fit)
    if not counts or slip_curve_fit.slip_variance(s.fit) <= least_spread * least_spread:
        s.falling = 0.0
        return False
    peak = slip_curve_fit.fitted_peak(p, s.fit)
    s.falling = s.falling + 1.0 if peak <= s.slip else 0.0
    if peak > s.slip or s.falling < p.hits:
        return False
    s.falling, s.peak = 0.0, peak
    return True


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

    It only falls: below the peak nothing shows that the road has become better.
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
