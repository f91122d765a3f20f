"""Traction control by estimated friction times load (dissertation, eq 1.2)."""

from __future__ import annotations

from dataclasses import dataclass, field

from ev_control.asr.reference_speed import ReferenceSpeedParameters
from ev_control.asr.traction_control import LimitedWheel, TractionControl, WheelMotion
from ev_control.asr.wheel_dynamics import Filtered, effective_inertia, filter_share, road_torque
from ev_msgs_py.methods import method
from ev_msgs_py.parameters import group, parameter
from ev_msgs_py.vehicle import Vehicle

_GRAVITY = 9.81  # [m/s^2]


@dataclass(frozen=True, slots=True)
class AdhesionLimitParameters:
    """How the friction of the road is estimated; the source takes it as known."""

    largest_friction: float = parameter(
        1.2, unit="1", low=0.01, high=3.0, about="friction at the start and at most", source="assumption"
    )
    learning_slip: float = parameter(
        0.15,
        unit="1",
        low=0.01,
        high=1.0,
        about="slip from which on the friction in use is taken for the friction of the road",
        source="assumption",
    )
    filter_time: float = parameter(
        0.02, unit="s", low=0.0, high=1.0, about="time constant of the friction in use", source="assumption"
    )
    rise: float = parameter(
        0.3,
        unit="1/s",
        low=0.0,
        high=100.0,
        about="rise of the estimate without slip, which finds out when the road gets better",
        source="assumption",
    )
    use: float = parameter(
        0.95,
        unit="1",
        low=0.1,
        high=1.0,
        about="share of the estimate that is used; at 1 a wheel that spins has just the torque to spin on",
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
    reference: ReferenceSpeedParameters = group(ReferenceSpeedParameters)


@dataclass(slots=True)
class AdhesionLimitWheel(LimitedWheel):
    """Filtered friction in use [1], and the estimated friction of the road [1]."""

    used: Filtered = field(default_factory=Filtered)
    friction: float = 0.0


@method("asr", "adhesion_limit")
class AdhesionLimit(TractionControl):
    """Limit each wheel to mu F_z r, with the load by the accelerations and the friction at which it last slipped.

    Dissertation, eq 1.2, at the wheel instead of the shaft. The load is that of a rigid car on a level road:
    F_z = m (g b/L -+ h a_x/L)/2 -+ k h m a_y/t. The friction in use is (M - J w')/(F_z r); where the slip exceeds
    `learning_slip` it is that of the road, else the estimate slowly rises to `largest_friction` (assumption): a
    saw tooth that finds a better road only after a while, and a worse one by slipping.
    """

    parameters = AdhesionLimitParameters

    def __init__(self, parameters: AdhesionLimitParameters, vehicle: Vehicle, period: float) -> None:
        p = self._p = parameters
        self._inertia, self._radius = effective_inertia(vehicle), vehicle.wheel_radius
        self._efficiency = vehicle.motor.gear_efficiency
        self._share, self._rise = filter_share(period, p.filter_time), p.rise * period
        front, roll = vehicle.centre_of_mass_to_rear_axle / vehicle.wheelbase, vehicle.front_roll_share
        half_mass, height = vehicle.mass / 2, vehicle.centre_of_mass_height
        along = half_mass * height / vehicle.wheelbase
        across = (
            2 * half_mass * height * roll / vehicle.front_track,
            2 * half_mass * height * (1 - roll) / vehicle.rear_track,
        )
        self._static = (half_mass * _GRAVITY * front,) * 2 + (half_mass * _GRAVITY * (1 - front),) * 2
        self._by_longitudinal = (-along, -along, along, along)
        self._by_lateral = (-across[0], across[0], -across[1], across[1])
        super().__init__("adhesion_limit", self._new, p.reference, vehicle, period)

    def _new(self) -> AdhesionLimitWheel:
        return AdhesionLimitWheel(friction=self._p.largest_friction)

    def _limit(self, wheel: AdhesionLimitWheel, motion: WheelMotion, wanted: float) -> float:
        """The torque that the estimated friction carries [N m]."""
        p = self._p
        lever = self._load(motion) * self._radius
        used = wheel.used.follow(road_torque(motion, self._inertia) / lever, self._share)
        if motion.slip(p.slowest) > p.learning_slip:
            wheel.friction = min(max(used, 0.0), wheel.friction)
        else:
            wheel.friction = min(wheel.friction + self._rise, p.largest_friction)
        return p.use * wheel.friction * lever / self._efficiency

    def _load(self, motion: WheelMotion) -> float:
        """Load of the wheel [N]; never below a tenth of the one at rest, where the car would be on three wheels."""
        i, static = motion.place, self._static[motion.place]
        load = static + self._by_longitudinal[i] * motion.forward_acceleration
        return max(load + self._by_lateral[i] * motion.lateral_acceleration, 0.1 * static)
