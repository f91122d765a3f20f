"""Nonlinear slip control by feedback linearisation (dissertation, section 1.3, figure 1.19)."""

from __future__ import annotations

from dataclasses import dataclass, field

from ev_control.asr.slip_regulator import RegulatedWheel, SlipRegulator, SlipRegulatorParameters
from ev_control.asr.traction_control import WheelMotion
from ev_control.asr.wheel_dynamics import road_torque
from ev_control.first_order_filter import Filtered, filter_share
from ev_msgs_py.methods import method
from ev_msgs_py.parameters import group, parameter
from ev_msgs_py.vehicle import Vehicle


@dataclass(frozen=True, slots=True)
class FeedbackLinearisationParameters:
    """How fast the slip error decays, and how fast the road is believed to change; the source gives neither."""

    rate: float = parameter(
        25.0, unit="1/s", low=0.1, high=1000.0, about="decay of the slip error, k", source="assumption"
    )
    road_filter: float = parameter(
        0.02, unit="s", low=0.0, high=1.0, about="time constant of road torque and acceleration", source="assumption"
    )
    regulator: SlipRegulatorParameters = group(SlipRegulatorParameters)


@dataclass(slots=True)
class FeedbackLinearisationWheel(RegulatedWheel):
    """Filtered road torque [N m] and acceleration of the car [m/s^2]."""

    road: Filtered = field(default_factory=Filtered)
    body_acceleration: Filtered = field(default_factory=Filtered)


@method("asr", "feedback_linearisation")
class FeedbackLinearisation(SlipRegulator):
    """Choose the torque that makes the slip error decay exponentially, whatever the tyre's curve is.

    With S = 1 - V/(r w), S' = ((1 - S) w' - V'/r)/w and J w' = M - M_road,

        M = M_road + J/(1 - S) (V'/r - k w (S - S*))

    gives S' = -k (S - S*) (dissertation, section 1.3, which names the method but gives no equation). The road torque
    M_road = M - J w' is measured and filtered, V' is the acceleration of the car. Near full slip 1/(1 - S) is taken
    at S = 0.9.
    """

    parameters = FeedbackLinearisationParameters

    def __init__(self, parameters: FeedbackLinearisationParameters, vehicle: Vehicle, period: float) -> None:
        p = parameters
        self._rate, self._share = p.rate, filter_share(period, p.road_filter)
        self._inertia, self._radius = vehicle.driven_wheel_inertia, vehicle.wheel_radius
        self._efficiency = vehicle.motor.gear_efficiency
        super().__init__("feedback_linearisation", FeedbackLinearisationWheel, p.regulator, vehicle, period)

    def _watch(self, wheel: FeedbackLinearisationWheel, motion: WheelMotion) -> None:
        wheel.road.follow(road_torque(motion, self._inertia), self._share)
        wheel.body_acceleration.follow(motion.body_acceleration, self._share)

    def _regulated(
        self, wheel: FeedbackLinearisationWheel, motion: WheelMotion, slip: float, wanted: float, begins: bool
    ) -> float:
        speed = max(motion.speed, self._regulator.slip.slowest)
        needed = wheel.body_acceleration.value / self._radius - self._rate * speed * (slip - self._regulator.target)
        torque = wheel.road.value + self._inertia / (1 - min(slip, 0.9)) * needed
        return torque / self._efficiency
