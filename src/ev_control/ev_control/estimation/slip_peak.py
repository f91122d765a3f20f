"""Whether the slip of a wheel has passed the peak of its curve, by least squares (dissertation, eqs 2.34 to 2.36)."""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.estimation.first_order_filter import start_again
from ev_control.estimation.slip_curve import SlipCurveParameters, fitted_peak
from ev_control.estimation.slip_curve_fit import (
    SlipCurveFit,
    add_sample,
    is_full,
    mean_slip,
    slip_variance,
)
from ev_control.estimation.wheel_dynamics import slowest_wheel
from ev_core.law import compilable, entry, parameter, part

FEWEST_SAMPLES = 8  # four for each coefficient


@dataclass(frozen=True, slots=True)
class SlipPeakParameters(SlipCurveParameters):
    """The window of the fit, and when it counts; the source gives none of them."""

    window: float = parameter(
        0.125,
        unit="s",
        low=0.01,
        high=2.0,
        about="length of the window; shorter than 0.05 s misses peaks, longer than 0.25 s is late",
    )
    slowest: float = slowest_wheel()
    offset: float = parameter(
        1e-4,
        unit="1",
        low=1e-9,
        high=0.1,
        about="added to the slip under the square root, whose slope at no slip stays finite then",
    )
    least_slip: float = parameter(
        0.03,
        unit="1",
        low=0.0,
        high=0.5,
        about="slip below which nothing is a hit, and least slip that is regulated to",
    )
    speed_noise: float = parameter(
        0.03,
        unit="rad/s",
        low=1e-4,
        high=10.0,
        about="standard deviation of the measured wheel speeds; scatter that it explains is no reason to fit",
    )
    spread: float = parameter(
        3.0,
        unit="1",
        low=0.0,
        high=100.0,
        about="standard deviation of the slip in the window over that of its noise, from which on the fit counts",
    )
    hits: int = parameter(5, unit="1", low=1, high=100, about="steps in a row in which the curve falls, for a hit")


@dataclass(slots=True)
class SlipPeakState:
    """What lasts between steps."""

    fit: SlipCurveFit = part(SlipCurveFit)
    slip: float = entry(unit="1", about="last slip")
    falling: float = entry(unit="1", about="steps in a row in which the curve falls")
    peak: float = entry(unit="1", about="slip of the peak at the last hit")


forget_peak = start_again(SlipPeakState)


@compilable
def watch_slip(p: SlipPeakParameters, s: SlipPeakState, period: float, slip: float, torque: float) -> None:
    """Take the slip at the end of a period [1], and the mean torque of the road in it over its nominal value [1].

    The torque goes with the mean slip of the period: then the noise of the speeds, which is in both, does not tilt the
    curve.
    """
    samples = float(max(round(p.window / period), FEWEST_SAMPLES))
    add_sample(s.fit, samples, p.offset, (slip + s.slip) / 2.0, torque, p.template)
    s.slip = slip


@compilable
def peak_is_passed(p: SlipPeakParameters, s: SlipPeakState, noise: float) -> bool:
    """Whether the fitted curve falls at the present slip, for long enough; notes the slip of its peak.

    A fit counts if the slip spreads more than its noise [1] explains, and exceeds both `least_slip` and the window's
    mean.
    """
    least_spread = p.spread * noise
    counts = s.slip > p.least_slip and is_full(s.fit) and s.slip > mean_slip(s.fit)
    if not counts or slip_variance(s.fit) <= least_spread * least_spread:
        s.falling = 0.0
        return False
    peak = fitted_peak(p, s.fit)
    s.falling = s.falling + 1.0 if peak <= s.slip else 0.0
    if peak > s.slip or s.falling < p.hits:
        return False
    s.falling, s.peak = 0.0, peak
    return True
