"""Slip control by proportional and integral action (dissertation, section 1.3, figure 1.18)."""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.asr.slip_regulator import RegulatedWheel, SlipRegulator, SlipRegulatorParameters
from ev_control.asr.traction_control import WheelMotion
from ev_msgs_py.methods import method
from ev_msgs_py.parameters import group, parameter
from ev_msgs_py.vehicle import Vehicle


@dataclass(frozen=True, slots=True)
class PiSlipParameters:
    """Where the two poles of the slip lie; the source gives no gains."""

    natural_frequency: float = parameter(
        20.0, unit="rad/s", low=0.1, high=1000.0, about="natural frequency of the slip", source="assumption"
    )
    damping_ratio: float = parameter(
        1.0, unit="1", low=0.1, high=10.0, about="damping ratio of the slip", source="assumption"
    )
    regulator: SlipRegulatorParameters = group(SlipRegulatorParameters)


@dataclass(slots=True)
class PiSlipWheel(RegulatedWheel):
    """Integral part of the limit [N m]."""

    integral: float = 0.0


@method("asr", "pi_slip")
class PiSlip(SlipRegulator):
    """Bring the slip of each wheel to its target by proportional and integral action.

    Limit = J w (2 D w_0 e + w_0^2 integral(e)), e = S* - S, from the torque at which the slip exceeded S*. About a
    point of work the wheel alone gives J w S' = M - M_road, so the gains J w 2 D w_0 and J w w_0^2 place two poles of
    the natural frequency w_0; the slope of the tyre's curve, which is not linear, is left to them. Behind the peak it
    pushes them apart, the more the slower the wheel turns: with a target there the slip swings at low speed.
    Dissertation, section 1.3: a PI controller for small changes about a point of work. The integral stops at the
    request.
    """

    parameters = PiSlipParameters

    def __init__(self, parameters: PiSlipParameters, vehicle: Vehicle, period: float) -> None:
        p = parameters
        self._inertia = vehicle.driven_wheel_inertia
        self._proportional = 2 * p.damping_ratio * p.natural_frequency
        self._integral_step = p.natural_frequency**2 * period
        super().__init__("pi_slip", PiSlipWheel, p.regulator, vehicle, period)

    def _regulated(self, wheel: PiSlipWheel, motion: WheelMotion, slip: float, wanted: float, begins: bool) -> float:
        if begins:
            wheel.integral = min(max(motion.torque, 0.0), wanted)
        error = self._regulator.target - slip
        gain = self._inertia * max(motion.speed, self._regulator.slip.slowest)
        wheel.integral = min(max(wheel.integral + gain * self._integral_step * error, 0.0), wanted)
        return wheel.integral + gain * self._proportional * error
