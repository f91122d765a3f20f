"""A differential whose locking grows with the speed difference, method 4 of the dissertation's five."""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.electronic_differential.locking import Locking, locking_share
from ev_control.electronic_differential.torque_split import BrakeSplitParameters, TorqueSplit
from ev_msgs_py.methods import method
from ev_msgs_py.parameters import group, parameter
from ev_msgs_py.signals import DriverCommand, WheelStates, WheelTorqueRequest
from ev_msgs_py.vehicle import Vehicle


@dataclass(frozen=True, slots=True)
class LimitedSlipVariableParameters:
    """The largest locking coefficient, and the speed difference that it needs."""

    largest_locking_ratio: float = parameter(
        1.5,
        unit="1",
        low=1.0,
        high=20.0,
        about="torque of the slower over that of the faster wheel at most, K",
        source="dissertation, section 3.4",
    )
    full_locking_speed: float = parameter(
        5.0,
        unit="rad/s",
        low=0.01,
        high=1000.0,
        about="speed difference of the wheels from which on the locking is the largest",
        source="assumption: the source has K from 1 to 1.5 with the speed difference, but not over which",
    )
    brake: BrakeSplitParameters = group(BrakeSplitParameters)


@method("electronic_differential", "limited_slip_variable")
class LimitedSlipVariable:
    """Give the slower wheel of each driven axle up to K times the torque of the faster one, as their speeds differ.

    M_slow/M_fast = 1 + (K - 1) min(|d|/d_full, 1) with the speed difference d of the wheels and K = 1.5 (dissertation,
    section 3.4); the sum is the driver's. ValueError if the vehicle has no driven wheel.
    """

    parameters = LimitedSlipVariableParameters
    state = None  # nothing lasts between steps

    def __init__(self, parameters: LimitedSlipVariableParameters, vehicle: Vehicle, period: float) -> None:
        self._split = TorqueSplit(parameters.brake, vehicle)
        self._rise, self._full = parameters.largest_locking_ratio - 1.0, parameters.full_locking_speed
        self._locking = Locking(vehicle, self._share)

    def _share(self, difference: float) -> float:
        share = locking_share(1.0 + self._rise * min(abs(difference) / self._full, 1.0))
        return share if difference >= 0.0 else -share

    def step(self, driver: DriverCommand, wheels: WheelStates) -> WheelTorqueRequest:
        """Wheel torques [N m] by the wheel speeds."""
        request = self._split.request(driver)
        return WheelTorqueRequest(self._locking.locked(request.drive, wheels.velocity), request.brake)
