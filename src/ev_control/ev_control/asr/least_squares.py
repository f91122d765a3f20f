"""Traction control that finds the peak of the slip curve by least squares (dissertation, eqs 2.34 to 2.36)."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf

from ev_control.estimation.slip_peak import SlipPeakState, peak_is_passed, watch_slip
from ev_control.estimation.wheel_dynamics import WheelMotion, road_torque, share_at, slip_of
from ev_control.law import Filtered, LimitedWheel, filter_share, follow, traction_control, until_served
from ev_control.shared.least_squares_parameters import LeastSquaresParameters
from ev_core.law import Car, compilable, entry, part, sqrt

LARGEST_TARGET = 0.9  # [1]; the speed that belongs to a slip grows with 1/(1 - x)


@dataclass(slots=True)
class LeastSquaresWheel(LimitedWheel):
    """What the law knows of a wheel."""

    curve: SlipPeakState = part(SlipPeakState)
    road: Filtered = part(Filtered)  # torque that the road takes [N m]
    target: float = entry(unit="1", about="slip that is regulated to; zero while the request is not limited")
    held: float = entry(unit="s", about="since when the target stays")
    served: float = entry(unit="s", about="since when the limit is above the request")


@traction_control("least_squares", LeastSquaresParameters, LeastSquaresWheel)
@compilable
def least_squares(
    p: LeastSquaresParameters, car: Car, w: LeastSquaresWheel, period: float, motion: WheelMotion, wanted: float
) -> float:
    """Find the peak of the slip curve by least squares, and keep a wheel that has passed it at the slip of the peak.

    y = A x + B sqrt(x + e) is fitted to the last samples of the slip x = 1 - w_free/w and of the road torque
    y = (M - J w')/M_nom; the peak is passed where dy/dx < 0 at the present slip (dissertation, eqs 2.34 to 2.36, which
    take the motor torque: what the law itself commands says nothing of the road). The rest is assumption:

    - A slip beyond `backstop` is a hit as well as `hits` fits in a row that fall: ice has no peak.
    - After a hit the slip x* = (B/(2 A))^2 is the target, and the limit is what the road takes, plus what the wheel
      needs to follow the car and to close the gap of its speed to the target w* with `bandwidth`:
      M = M_road + J (a_x/(r (1 - x*)) + bandwidth (w* - w)). It goes with the friction of the road by itself.
    - The target stays for `hold` and then rises until the next hit, just fast enough for the noise. At the backstop
      it begins anew. The limit ends once it has been above the request for `release`.
    """
    slip, road = slip_of(motion, p.slowest), road_torque(car, motion)
    watch_slip(p, w.curve, period, slip, road / (car.motor.nominal_torque * car.gear_ratio))
    road = follow(w.road, road, filter_share(period, p.road_filter))
    aim(p, w, period, motion)
    if w.target == 0.0:
        return inf
    least = w.target * share_at(motion, p.slowest, p.at_rest) * p.slowest
    wanted_speed = max(motion.rolling / (1.0 - w.target), motion.rolling + least)
    acceleration = motion.body_acceleration / (car.wheel_radius * (1.0 - w.target))
    acceleration += p.bandwidth * (wanted_speed - motion.speed)
    torque = (road + car.driven_wheel_inertia[motion.place] * acceleration) / car.motor.gear_efficiency
    held = until_served(p, w, period, torque, wanted)
    if held == inf:
        w.target = 0.0
    return held


@compilable
def aim(p: LeastSquaresParameters, w: LeastSquaresWheel, period: float, motion: WheelMotion) -> None:
    """Set the slip to regulate to, from the fit, the backstop, or the search for the next hit."""
    noise = p.speed_noise / max(motion.speed, p.slowest)
    if peak_is_passed(p, w.curve, noise):
        # With z = sqrt(x/x*) the fitted curve is y/y* = 2 z - z^2, and z below 1 is the stable side.
        z = 1.0 - sqrt(1.0 - p.use)
        w.target, w.held = min(max(z * z * w.curve.peak, p.least_slip), LARGEST_TARGET), 0.0
    elif w.target == 0.0:
        if w.curve.slip > p.backstop:
            w.target, w.held = p.first_slip, 0.0
    elif w.held < p.hold:
        w.held += period
    elif w.target < p.backstop:
        # A slip that rises evenly by d within the window has the standard deviation d/sqrt(12).
        rise = p.probe * p.spread * sqrt(12.0) / w.curve.fit.size
        w.target = min(w.target + rise * noise, p.backstop)
    else:
        w.target, w.held = p.first_slip, 0.0
