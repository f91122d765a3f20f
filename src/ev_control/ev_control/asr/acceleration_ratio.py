"""Traction control by the ratio of the car's to the wheel's acceleration (dissertation, eq 1.4)."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from ev_control.asr.traction_control import LimitedWheel, TractionControl, WheelMotion
from ev_control.first_order_filter import Filtered, filter_share
from ev_control.reference_speed import ReferenceSpeedParameters
from ev_msgs_py.methods import method
from ev_msgs_py.parameters import group, parameter
from ev_msgs_py.vehicle import Vehicle


@dataclass(frozen=True, slots=True)
class AccelerationRatioParameters:
    """The ratio that tells slip from grip, and how the limit moves."""

    threshold: float = parameter(
        0.16,
        unit="m",
        low=0.0,
        high=10.0,
        about="ratio of accelerations below which a wheel slips; 0.4 in the source, more than any wheel radius, would "
        "always be undercut; half the radius stands for a wheel that turns twice as fast as it would roll",
        source="assumption; dissertation, eq 1.4, has 0.4 m",
    )
    least_acceleration: float = parameter(
        6.0,
        unit="rad/s^2",
        low=0.0,
        high=1000.0,
        about="wheel acceleration below which the ratio is noise",
        source="assumption",
    )
    filter_time: float = parameter(
        0.03, unit="s", low=0.0, high=1.0, about="time constant of both accelerations", source="assumption"
    )
    fall: float = parameter(
        8000.0, unit="N m/s", low=1.0, high=1e6, about="fall of the limit while the wheel slips", source="assumption"
    )
    rise: float = parameter(
        500.0, unit="N m/s", low=1.0, high=1e6, about="rise of the limit while it grips", source="assumption"
    )
    reference: ReferenceSpeedParameters = group(ReferenceSpeedParameters)


@dataclass(slots=True)
class AccelerationRatioWheel(LimitedWheel):
    """Filtered accelerations of the wheel [rad/s^2] and of the car [m/s^2]."""

    wheel_acceleration: Filtered = field(default_factory=Filtered)
    body_acceleration: Filtered = field(default_factory=Filtered)


@method("asr", "acceleration_ratio")
class AccelerationRatio(TractionControl):
    """Lower a wheel's torque limit while the wheel accelerates out of proportion to the car, a_x/w' < threshold.

    A rolling wheel has a_x/w' = r, a slipping one less (dissertation, eq 1.4). The source wants to intervene where
    the ratio exceeds 0.4 m, which for its wheel of 0.32 m never happens, and prints a_x/w' < 0.4, which is always
    true; the sign of eq 1.4 is right, the value is not. The ratio is compared without dividing, and only while the
    wheel accelerates more than noise does. It sees slip that grows, not slip: a wheel that spins at a steady speed is
    left to spin, and the slip that built up before the limit fell stays.
    """

    parameters = AccelerationRatioParameters

    def __init__(self, parameters: AccelerationRatioParameters, vehicle: Vehicle, period: float) -> None:
        p = self._p = parameters
        self._fall, self._rise = p.fall * period, p.rise * period
        self._share = filter_share(period, p.filter_time)
        super().__init__("acceleration_ratio", AccelerationRatioWheel, p.reference, vehicle, period)

    def _limit(self, wheel: AccelerationRatioWheel, motion: WheelMotion, wanted: float) -> float:
        """The last limit [N m], lower while the wheel slips, higher while it grips."""
        p = self._p
        turning = wheel.wheel_acceleration.follow(motion.acceleration, self._share)
        moving = wheel.body_acceleration.follow(motion.body_acceleration, self._share)
        if turning > p.least_acceleration and moving < p.threshold * turning:
            return min(wheel.limit, wanted) - self._fall
        limit = wheel.limit + self._rise
        return limit if limit < wanted else math.inf
