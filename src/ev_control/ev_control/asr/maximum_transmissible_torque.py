"""Traction control by the largest torque that the tyre can transmit (dissertation, eq 1.7)."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

from ev_control.asr.traction_control import LimitedWheel, TractionControl, WheelMotion
from ev_control.asr.wheel_dynamics import mass_share, road_torque
from ev_control.first_order_filter import Filtered, filter_share
from ev_control.reference_speed import ReferenceSpeedParameters
from ev_msgs_py.methods import method
from ev_msgs_py.parameters import group, parameter
from ev_msgs_py.vehicle import Vehicle


@dataclass(frozen=True, slots=True)
class MaximumTransmissibleTorqueParameters:
    """The relaxation factor, and when the limit counts; the source gives none of them."""

    relaxation: float = parameter(
        0.9,
        unit="1",
        low=0.1,
        high=1.0,
        about="acceleration of the car over that of the tyre's tread which is allowed, a/r",
        source="assumption",
    )
    filter_time: float = parameter(
        0.03, unit="s", low=0.0, high=1.0, about="time constant of force and accelerations", source="assumption"
    )
    margin: float = parameter(
        1.0,
        unit="m/s^2",
        low=0.0,
        high=50.0,
        about="acceleration of the tread over the allowed one that is noise, or a carcass that winds up",
        source="assumption",
    )
    rise: float = parameter(
        1000.0,
        unit="N m/s",
        low=1.0,
        high=1e6,
        about="rise of the limit while the wheel follows the car; by eq 1.7 alone, no force stays no force",
        source="assumption",
    )
    reference: ReferenceSpeedParameters = group(ReferenceSpeedParameters)


@dataclass(slots=True)
class MaximumTransmissibleTorqueWheel(LimitedWheel):
    """Filtered road torque [N m], tread and car acceleration [m/s^2]."""

    road: Filtered = field(default_factory=Filtered)
    tread_acceleration: Filtered = field(default_factory=Filtered)
    body_acceleration: Filtered = field(default_factory=Filtered)


@method("asr", "maximum_transmissible_torque")
class MaximumTransmissibleTorque(TractionControl):
    """Limit a wheel that gains on the car to the torque that lets both accelerate in a fixed proportion.

    T = (J/(alpha M r^2) + 1) r F_d, with the force F_d = (M_w - J w')/r: with it the tread accelerates 1/alpha times as
    fast as the car (dissertation, eq 1.7). The source prints r where r^2 belongs if the factor is the pure number
    alpha; with its own definition, a_x/w' [m] = alpha r, the printed r is right. M is what one wheel moves, not the
    whole car. No speed of the car is needed but for the direction, and like every law that only knows accelerations
    this one keeps slip from growing but does not undo it.
    """

    parameters = MaximumTransmissibleTorqueParameters

    def __init__(self, parameters: MaximumTransmissibleTorqueParameters, vehicle: Vehicle, period: float) -> None:
        p = self._p = parameters
        self._inertia, self._radius = vehicle.driven_wheel_inertia, vehicle.wheel_radius
        ratio = self._inertia / (p.relaxation * mass_share(vehicle) * vehicle.wheel_radius**2)
        self._torque_factor = (ratio + 1) / vehicle.motor.gear_efficiency
        self._share, self._rise = filter_share(period, p.filter_time), p.rise * period
        super().__init__("maximum_transmissible_torque", MaximumTransmissibleTorqueWheel, p.reference, vehicle, period)

    def _limit(self, wheel: MaximumTransmissibleTorqueWheel, motion: WheelMotion, wanted: float) -> float:
        """T of eq 1.7 [N m] while the wheel gains on the car, else a limit that rises."""
        p, share = self._p, self._share
        road = wheel.road.follow(road_torque(motion, self._inertia), share)
        tread = wheel.tread_acceleration.follow(self._radius * motion.acceleration, share)
        body = wheel.body_acceleration.follow(motion.body_acceleration, share)
        if p.relaxation * tread > body + p.margin:
            return self._torque_factor * max(road, 0.0)
        limit = wheel.limit + self._rise
        return limit if limit < wanted else math.inf
