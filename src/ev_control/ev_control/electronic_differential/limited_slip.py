"""A differential with constant locking, method 3 of the dissertation's five."""

from __future__ import annotations

from dataclasses import dataclass
from math import tanh

from ev_control.electronic_differential.locking import Locking, locking_share
from ev_control.electronic_differential.torque_split import BrakeSplitParameters, TorqueSplit
from ev_msgs_py.methods import method
from ev_msgs_py.parameters import group, parameter
from ev_msgs_py.signals import DriverCommand, WheelStates, WheelTorqueRequest
from ev_msgs_py.vehicle import Vehicle


@dataclass(frozen=True, slots=True)
class LimitedSlipParameters:
    """The locking coefficient, and over which speed difference it changes sides."""

    locking_ratio: float = parameter(
        1.5,
        unit="1",
        low=1.0,
        high=20.0,
        about="torque of the slower over that of the faster wheel, K",
        source="dissertation, section 3.3",
    )
    locking_speed: float = parameter(
        0.5,
        unit="rad/s",
        low=0.01,
        high=100.0,
        about="speed difference of the wheels at which 76 % of the locking torque acts",
        source="assumption: friction has no sign at rest",
    )
    brake: BrakeSplitParameters = group(BrakeSplitParameters)


@method("electronic_differential", "limited_slip")
class LimitedSlip:
    """Give the slower wheel of each driven axle K times the torque of the faster one.

    M_slow/M_fast = K = 1.5 (dissertation, section 3.3), smoothed by tanh of the speed difference; the sum is the
    driver's. ValueError if the vehicle has no driven wheel.
    """

    parameters = LimitedSlipParameters
    state = None  # nothing lasts between steps

    def __init__(self, parameters: LimitedSlipParameters, vehicle: Vehicle, period: float) -> None:
        self._split = TorqueSplit(parameters.brake, vehicle)
        most, speed = locking_share(parameters.locking_ratio), parameters.locking_speed
        self._locking = Locking(vehicle, lambda difference: most * tanh(difference / speed))

    def step(self, driver: DriverCommand, wheels: WheelStates) -> WheelTorqueRequest:
        """Wheel torques [N m] by the wheel speeds."""
        request = self._split.request(driver)
        return WheelTorqueRequest(self._locking.locked(request.drive, wheels.velocity), request.brake)
