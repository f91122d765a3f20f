"""Traction control that finds the peak of the slip curve by least squares (dissertation, eqs 2.34 to 2.36)."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from ev_control.asr.slip_curve_fit import SlipCurveFit
from ev_control.asr.traction_control import LimitedWheel, TractionControl, WheelMotion
from ev_control.asr.wheel_dynamics import road_torque
from ev_control.first_order_filter import Filtered, filter_share
from ev_control.reference_speed import ReferenceSpeedParameters
from ev_msgs_py.methods import method
from ev_msgs_py.parameters import ParameterError, group, parameter
from ev_msgs_py.vehicle import Vehicle

_FEWEST_SAMPLES = 8  # four for each coefficient


@dataclass(frozen=True, slots=True)
class LeastSquaresParameters:
    """The window of the fit, when it counts, and how slip is regulated after a hit; the source gives none of them."""

    window: float = parameter(
        0.125,
        unit="s",
        low=0.01,
        high=2.0,
        about="length of the window; shorter than 0.05 s misses peaks, longer than 0.25 s is late",
        source="assumption",
    )
    slowest: float = parameter(
        3.0,
        unit="rad/s",
        low=0.1,
        high=100.0,
        about="wheel speed below which slip is counted against this speed, so that rest is no slip",
        source="assumption",
    )
    offset: float = parameter(
        1e-4,
        unit="1",
        low=1e-9,
        high=0.1,
        about="added to the slip under the square root, whose slope at no slip stays finite then",
        source="assumption",
    )
    least_slip: float = parameter(
        0.03,
        unit="1",
        low=0.0,
        high=0.5,
        about="slip below which nothing is a hit, and least slip that is regulated to",
        source="assumption",
    )
    speed_noise: float = parameter(
        0.03,
        unit="rad/s",
        low=1e-4,
        high=10.0,
        about="standard deviation of the measured wheel speeds; scatter that it explains is no reason to fit",
        source="assumption",
    )
    spread: float = parameter(
        3.0,
        unit="1",
        low=0.0,
        high=100.0,
        about="standard deviation of the slip in the window over that of its noise, from which on the fit counts",
        source="assumption",
    )
    hits: int = parameter(
        5, unit="1", low=1, high=100, about="steps in a row in which the curve falls, for a hit", source="assumption"
    )
    backstop: float = parameter(
        0.3,
        unit="1",
        low=0.05,
        high=0.9,
        about="slip that is a hit whatever the fit says: it was too late, or there is no peak, as on ice",
        source="assumption",
    )
    first_slip: float = parameter(
        0.08,
        unit="1",
        low=0.01,
        high=0.5,
        about="slip that is regulated to where the backstop was the hit, which tells nothing of the peak",
        source="assumption",
    )
    use: float = parameter(
        1.0,
        unit="1",
        low=0.5,
        high=1.0,
        about="share of the fitted peak that is used after a hit, on its stable side; 1 is the peak itself, less costs "
        "little force and saves much slip",
        source="assumption: the source takes the torque of the step before the peak was passed",
    )
    bandwidth: float = parameter(
        25.0,
        unit="1/s",
        low=0.1,
        high=1000.0,
        about="rate at which the slip approaches its target",
        source="assumption",
    )
    road_filter: float = parameter(
        0.02, unit="s", low=0.0, high=1.0, about="time constant of the road torque", source="assumption"
    )
    hold: float = parameter(
        0.3, unit="s", low=0.0, high=100.0, about="time for which the target stays after a hit", source="assumption"
    )
    probe: float = parameter(
        1.5,
        unit="1",
        low=0.0,
        high=100.0,
        about="rise of the target after that, over the slowest one whose slips spread enough in a window to be fitted",
        source="assumption",
    )
    release: float = parameter(
        0.2,
        unit="s",
        low=0.0,
        high=100.0,
        about="time for which the road has to carry the whole request before the limit ends",
        source="assumption",
    )
    reference: ReferenceSpeedParameters = group(ReferenceSpeedParameters)

    def __post_init__(self) -> None:
        if max(self.least_slip, self.first_slip) > self.backstop:
            raise ParameterError(f"backstop is {self.backstop:g}, allowed is at least least_slip and first_slip")


@dataclass(slots=True)
class LeastSquaresWheel(LimitedWheel):
    """Samples, last slip [1], road torque [N m], steps of a hit, slips of peak and target [1], times in phases [s]."""

    fit: SlipCurveFit = field(default_factory=SlipCurveFit)
    slip: float = 0.0
    road: Filtered = field(default_factory=Filtered)
    falling: int = 0
    peak: float = 0.0
    target: float = 0.0  # zero while the request is not limited
    held: float = 0.0
    served: float = 0.0


@method("asr", "least_squares")
class LeastSquares(TractionControl):
    """Find the peak of the slip curve by least squares, and keep a wheel that has passed it at the slip of the peak.

    y = A x + B sqrt(x + e) is fitted to the last samples of the slip x = 1 - w_free/w and of the road torque
    y = (M - J w')/M_nom; the peak is passed where dy/dx < 0 at the present slip (dissertation, eqs 2.34 to 2.36). What
    makes that work, all of it assumption:

    - The road torque takes the place of the motor torque, which is what the law itself commands and says nothing of
      the road. It is the mean of a period, so it goes with the mean slip of the period: then the noise of the speeds,
      which is in both, does not tilt the curve.
    - A fit counts if the slip spreads more than its noise explains, and exceeds both `least_slip` and the window's
      mean; `hits` of them in a row are a hit. Slip beyond `backstop` is one, too: ice has no peak.
    - After a hit the slip x* = (B/(2 A))^2 of the fitted peak is the target. The limit is the road torque, plus what
      the wheel needs to follow the car and to close the gap of its speed to the target with `bandwidth`:
      M = M_road + J (a_x/(r (1 - x*)) + bandwidth (w* - w)); above the target that is less than the road takes.
    - The target stays for `hold` and then rises until the next hit, just fast enough for the noise. At the backstop
      it begins anew. The limit ends once the road carries the whole request for `release`.

    Rest is no slip, and below `slowest` only slip beyond noise counts. On a jump to more friction the road torque, and
    with it the limit, grows by itself; on a jump to less it falls with the road torque within `road_filter`.
    """

    parameters = LeastSquaresParameters

    def __init__(self, parameters: LeastSquaresParameters, vehicle: Vehicle, period: float) -> None:
        p = self._p = parameters
        self._samples = max(round(p.window / period), _FEWEST_SAMPLES)
        self._inertia = vehicle.driven_wheel_inertia
        self._nominal = vehicle.motor.nominal_torque * vehicle.gear_ratio
        self._radius, self._efficiency = vehicle.wheel_radius, vehicle.motor.gear_efficiency
        self._road_share = filter_share(period, p.road_filter)
        # With z = sqrt(x/x*) the fitted curve is y/y* = 2 z - z^2, and z below 1 is the stable side.
        self._below_peak = (1.0 - math.sqrt(1.0 - p.use)) ** 2
        # A slip that rises evenly by d within the window has the standard deviation d/sqrt(12).
        self._probe = p.probe * p.spread * math.sqrt(12.0) / self._samples
        super().__init__("least_squares", self._new, p.reference, vehicle, period)

    def _new(self) -> LeastSquaresWheel:
        return LeastSquaresWheel(fit=SlipCurveFit(self._samples, self._p.offset))

    def _limit(self, wheel: LeastSquaresWheel, motion: WheelMotion, wanted: float) -> float:
        """Watch the fit; after a hit, the torque that keeps the slip at its target [N m]."""
        p = self._p
        slip, road = motion.slip(p.slowest), road_torque(motion, self._inertia)
        wheel.fit.add((slip + wheel.slip) / 2, road / self._nominal)
        wheel.slip = slip
        road = wheel.road.follow(road, self._road_share)
        self._aim(wheel, motion)
        if wheel.target == 0.0:
            return math.inf
        wanted_speed = max(motion.rolling / (1 - wheel.target), motion.rolling + wheel.target * p.slowest)
        acceleration = motion.body_acceleration / (self._radius * (1 - wheel.target))
        acceleration += p.bandwidth * (wanted_speed - motion.speed)
        limit = (road + self._inertia * acceleration) / self._efficiency
        wheel.served = wheel.served + self._period if limit >= wanted else 0.0
        if wheel.served > p.release:
            wheel.target = wheel.served = 0.0
            return math.inf
        return limit

    def _aim(self, wheel: LeastSquaresWheel, motion: WheelMotion) -> None:
        """Set the slip to regulate to, from the fit, the backstop, or the search for the next hit."""
        p = self._p
        noise = p.speed_noise / max(motion.speed, p.slowest)
        if self._peak_is_passed(wheel, noise):
            wheel.target, wheel.held = max(self._below_peak * wheel.peak, p.least_slip), 0.0
        elif wheel.target == 0.0:
            if wheel.slip > p.backstop:
                wheel.target, wheel.held = p.first_slip, 0.0
        elif wheel.held < p.hold:
            wheel.held += self._period
        elif wheel.target < p.backstop:
            wheel.target = min(wheel.target + self._probe * noise, p.backstop)
        else:
            wheel.target, wheel.held = p.first_slip, 0.0

    def _peak_is_passed(self, wheel: LeastSquaresWheel, noise: float) -> bool:
        """Whether the fitted curve falls at the present slip, for long enough; notes the slip of its peak."""
        p, fit, slip = self._p, wheel.fit, wheel.slip
        peak = None
        if slip > p.least_slip and fit.is_full and slip > fit.mean and fit.variance > (p.spread * noise) ** 2:
            peak = fit.peak()
        if peak is None or peak > slip:
            wheel.falling = 0
            return False
        wheel.falling += 1
        if wheel.falling < p.hits:
            return False
        wheel.falling, wheel.peak = 0, peak
        return True
