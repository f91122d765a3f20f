"""Traction control by estimated friction times load (dissertation, eq 1.2)."""

from __future__ import annotations

from dataclasses import dataclass, field

from ev_control.asr.traction_control import LimitedWheel, TractionControl, WheelMotion
from ev_control.asr.wheel_dynamics import road_torque
from ev_control.first_order_filter import Filtered, filter_share
from ev_control.friction_learning import FrictionLearningParameters
from ev_control.reference_speed import ReferenceSpeedParameters
from ev_control.wheel_loads import WheelLoads
from ev_msgs_py.methods import method
from ev_msgs_py.parameters import group, parameter
from ev_msgs_py.vehicle import Vehicle


@dataclass(frozen=True, slots=True)
class AdhesionLimitParameters(FrictionLearningParameters):
    """How the friction of the road is learnt, and how much of it is used."""

    use: float = parameter(
        0.95,
        unit="1",
        low=0.1,
        high=1.0,
        about="share of the estimate that is used; at 1 a wheel that spins has just the torque to spin on",
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

    Dissertation, eq 1.2, at the wheel instead of the shaft; loads by `WheelLoads`. The friction in use is
    (M - J w')/(F_z r); where the slip exceeds `learning_slip` it is that of the road, else the estimate slowly rises to
    `largest_friction` (assumption, see `FrictionLearningParameters.learnt`).
    """

    parameters = AdhesionLimitParameters

    def __init__(self, parameters: AdhesionLimitParameters, vehicle: Vehicle, period: float) -> None:
        p = self._p = parameters
        self._inertia, self._radius = vehicle.driven_wheel_inertia, vehicle.wheel_radius
        self._efficiency = vehicle.motor.gear_efficiency
        self._share = filter_share(period, p.filter_time)
        self._loads = WheelLoads(vehicle)
        super().__init__("adhesion_limit", self._new, p.reference, vehicle, period)

    def _new(self) -> AdhesionLimitWheel:
        return AdhesionLimitWheel(friction=self._p.largest_friction)

    def _limit(self, wheel: AdhesionLimitWheel, motion: WheelMotion, wanted: float) -> float:
        """The torque that the estimated friction carries [N m]."""
        p = self._p
        lever = self._loads.of(motion.place, motion.forward_acceleration, motion.lateral_acceleration) * self._radius
        used = wheel.used.follow(road_torque(motion, self._inertia) / lever, self._share)
        wheel.friction = p.learnt(wheel.friction, used, motion.slip(p.slowest), self._period)
        return p.use * wheel.friction * lever / self._efficiency
