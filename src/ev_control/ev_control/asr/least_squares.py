"""Traction control by the peak of a fitted slip curve (dissertation, eqs 2.34 to 2.36)."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

from ev_control.estimation import slip_curve_fit
from ev_control.estimation.reference_speed import ReferenceSpeedParameters
from ev_control.estimation.slip_peak import (
    SlipPeakParameters,
    SlipPeakState,
    peak_is_passed,
    watch_slip,
)
from ev_control.estimation.wheel_dynamics import share_at_rest
from ev_control.law import (
    Filtered,
    WheelMotion,
    filter_share,
    follow,
    road_torque,
    share_at,
    slip_of,
    until_served,
)
from ev_control.shared.limp_mode import LimpModeParameters
from ev_control.shared.traction_control import LimitedWheel, traction_control
from ev_core.law import Car, ParameterError, compilable, entry, group, parameter, part, sqrt

LARGEST_TARGET = 0.9  # [1]; the speed that belongs to a slip grows with 1/(1 - x)


@dataclass(frozen=True, slots=True)
class LeastSquaresParameters(SlipPeakParameters):
    """When the fit counts, and how slip is regulated after a hit; the source gives none of them."""

    backstop: float = parameter(
        0.3,
        unit="1",
        low=0.05,
        high=0.9,
        about="slip that is a hit whatever the fit: it is late, or there is no peak",
    )
    first_slip: float = parameter(
        0.08,
        unit="1",
        low=0.01,
        high=0.5,
        about="slip that is regulated to after the backstop, which shows no peak",
    )
    use: float = parameter(
        1.0,
        unit="1",
        low=0.5,
        high=1.0,
        about="share of the fitted peak that is used after a hit, on its stable side; 1 is the "
        "peak itself, less costs little force and saves much slip",
        source="assumption: the source takes the torque of the step before the peak was passed",
    )
    bandwidth: float = parameter(
        25.0, unit="1/s", low=0.1, high=1000.0, about="rate at which the slip approaches its target"
    )
    road_filter: float = parameter(
        0.02, unit="s", low=0.0, high=1.0, about="time constant of the road torque"
    )
    hold: float = parameter(
        0.3, unit="s", low=0.0, high=100.0, about="time for which the target stays after a hit"
    )
    probe: float = parameter(
        1.5,
        unit="1",
        low=0.0,
        high=100.0,
        about="rise of the target after that, over the slowest one with slips that spread enough "
        "in a window to be fitted",
    )
    release: float = parameter(
        0.2,
        unit="s",
        low=0.0,
        high=100.0,
        about="time for which the road carries the request before the limit ends",
    )
    at_rest: float = share_at_rest(0.3)
    reference: ReferenceSpeedParameters = group(ReferenceSpeedParameters)
    limp: LimpModeParameters = group(LimpModeParameters)

    def __post_init__(self) -> None:
        if max(self.least_slip, self.first_slip) > self.backstop:
            raise ParameterError(
                f"backstop is {self.backstop:g}, expected at least least_slip and first_slip"
            )


@dataclass(slots=True)
class LeastSquaresWheel(LimitedWheel):
    """State of a wheel."""

    curve: SlipPeakState = part(SlipPeakState)
    road: Filtered = part(Filtered)  # torque that the road takes [N m]
    target: float = entry(
        unit="1", about="slip that is regulated to; zero while the request is not limited"
    )
    held: float = entry(unit="s", about="since when the target stays")
    served: float = entry(unit="s", about="since when the limit is above the request")


@traction_control("least_squares")
@compilable
def least_squares(
    p: LeastSquaresParameters,
    car: Car,
    w: LeastSquaresWheel,
    period: float,
    motion: WheelMotion,
    wanted: float,
) -> float:
    """Find the peak of the slip curve by least squares, and keep a wheel that has passed it there.

    y = A x + B sqrt(x + e) is fitted to the last samples of the slip x = 1 - w_free/w and of the
    road torque y = (M - J w')/M_nom; the peak is passed where dy/dx < 0 at the present slip
    (dissertation, eqs 2.34 to 2.36, which take the motor torque: the law's own command does not
    depend on the road). The rest is assumption:

    - A slip beyond `backstop` is a hit as well as `hits` fits in a row that fall: ice has no peak.
    - After a hit the slip x* = (B/(2 A))^2 is the target, and the limit is what the road takes,
      plus what the wheel needs to follow the car and to close the gap of its speed to the target w*
      with `bandwidth`: M = M_road + J (a_x/(r (1 - x*)) + bandwidth (w* - w)). It goes with the
      friction of the road by itself.
    - The target stays for `hold` and then rises until the next hit, just fast enough for the noise.
      At the backstop it begins again. The limit ends once it has been above the request for
      `release`.
    """
    slip, road = slip_of(motion, p.slowest), road_torque(car, motion)
    watch_slip(p, w.curve, period, slip, road / (car.motor.nominal_torque * car.gear_ratio))
    road = follow(w.road, road, filter_share(period, p.road_filter))
    aim(p, w, period, motion)
    if w.target == 0.0:
        return inf
    # About rest a slip is no speed difference, so a least one is added.
    least = w.target * share_at(motion, p.slowest, p.at_rest) * p.slowest
    wanted_speed = max(motion.rolling / (1.0 - w.target), motion.rolling + least)
    acceleration = motion.body_acceleration / (car.wheel_radius * (1.0 - w.target))
    acceleration += p.bandwidth * (wanted_speed - motion.speed)
    inertia = car.driven_wheel_inertia[motion.place]
    torque = (road + inertia * acceleration) / car.motor.gear_efficiency
    held = until_served(p, w, period, torque, wanted)
    if held == inf:
        w.target = 0.0
    return held


@compilable
def aim(
    p: LeastSquaresParameters, w: LeastSquaresWheel, period: float, motion: WheelMotion
) -> None:
    """Set the slip to regulate to, from the fit, the backstop, or the search for the next hit."""
    noise = p.speed_noise / max(motion.speed, p.slowest)
    if peak_is_passed(p, w.curve, noise):
        # With z = sqrt(x/x*) the fitted curve is y/y* = 2 z - z^2, and z below 1 is the stable
        # side.
        z = 1.0 - sqrt(1.0 - p.use)
        w.target, w.held = min(max(z * z * w.curve.peak, p.least_slip), LARGEST_TARGET), 0.0
    # Not limited: without a fitted peak only a very large slip begins.
    elif w.target == 0.0:
        if w.curve.slip > p.backstop:
            w.target, w.held = p.first_slip, 0.0
    # After a hit the target stays, while the slip comes there.
    elif w.held < p.hold:
        w.held += period
    # Then it rises slowly, until the fit shows the peak again.
    elif w.target < p.backstop:
        # A slip that rises evenly by d within the window has the standard deviation d/sqrt(12).
        rise = p.probe * p.spread * sqrt(12.0) / w.curve.fit.size
        w.target = min(w.target + rise * noise, p.backstop)
    else:
        w.target, w.held = p.first_slip, 0.0


@dataclass(frozen=True, slots=True)
class LiteralFitParameters(slip_curve_fit.SlipCurveParameters):
    """The length of the window, which the source leaves open."""

    samples: int = parameter(
        25, unit="1", low=2, high=1000, about="samples in the window of the fit, n"
    )
    reference: ReferenceSpeedParameters = group(ReferenceSpeedParameters)
    limp: LimpModeParameters = group(LimpModeParameters)


@dataclass(slots=True)
class LiteralFitWheel(LimitedWheel):
    """State of a wheel."""

    fit: slip_curve_fit.SlipCurveFit = part(slip_curve_fit.SlipCurveFit)
    previous: float = entry(unit="N m", about="torque of the previous step")


@traction_control("least_squares_literal")
@compilable
def least_squares_literal(
    p: LiteralFitParameters,
    car: Car,
    w: LiteralFitWheel,
    period: float,
    motion: WheelMotion,
    wanted: float,
) -> float:
    """Hold the torque of the previous step while the fitted curve falls: a spinning wheel spins on.

    X = 1 - w_free/w, Y = M/M_nom, y = A x + B sqrt(x) over the window, dy/dx < 0 at the present X:
    the previous torque is the limit of this step (dissertation, eqs 2.34 to 2.36). For comparison
    only, because it does next to nothing: the torque that it holds is the one that spins the wheel,
    so it ends the rise of the torque but never takes any back. And Y is the law's own command: a
    constant torque of the driver makes a curve that does not depend on the road. What the source
    does not define is left out: a sample at rest (0/0), with X < 0 (its root), or a window with
    equations that have no single solution.
    """
    slip = 1.0 - motion.rolling / motion.speed if motion.speed != 0.0 else -1.0
    held = inf
    if 0.0 < slip <= 1.0:
        torque = motion.torque / (car.motor.nominal_torque * car.gear_ratio)
        slip_curve_fit.add_sample(w.fit, p.samples, 0.0, slip, torque, p.template)
        curve = slip_curve_fit.fitted_curve(w.fit)
        if (
            slip_curve_fit.is_full(w.fit)
            and slip_curve_fit.fits(p, w.fit, curve)
            and slip_curve_fit.slope(w.fit, curve, slip) < 0.0
        ):
            held = w.previous
    w.previous = min(wanted, held)
    return held
