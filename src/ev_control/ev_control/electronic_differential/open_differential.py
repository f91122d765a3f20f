"""The free symmetric differential, method 2 of the dissertation's five."""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.electronic_differential.torque_split import BrakeSplitParameters, TorqueSplit
from ev_msgs_py.methods import method
from ev_msgs_py.parameters import group
from ev_msgs_py.signals import DriverCommand, WheelTorqueRequest
from ev_msgs_py.vehicle import Vehicle
from ev_msgs_py.wheels import Wheels


@dataclass(frozen=True, slots=True)
class OpenDifferentialParameters:
    """Only the brakes leave a choice: the differential has no friction."""

    brake: BrakeSplitParameters = group(BrakeSplitParameters)


@method("electronic_differential", "open_differential")
class OpenDifferential:
    """Equal torques left and right as behind a mechanical differential, whose wheels cannot get more than both grip.

    M_left = M_right = M_axle/2 (dissertation, section 3.2), the torques of the axles alike. Other than `equal_torque`
    the drive is one whole: what one wheel of an axle does not deliver, because of its motor, the other one does not
    get either, as no gear could give it. ValueError if the vehicle has no driven wheel.
    """

    parameters = OpenDifferentialParameters
    state = None  # nothing lasts between steps

    def __init__(self, parameters: OpenDifferentialParameters, vehicle: Vehicle, period: float) -> None:
        self._split = TorqueSplit(parameters.brake, vehicle)
        self._most = vehicle.motor.peak_torque * vehicle.gear_ratio

    def step(self, driver: DriverCommand) -> WheelTorqueRequest:
        """Equal wheel torques [N m], none above what one motor has."""
        request = self._split.request(driver)
        most = self._most
        return WheelTorqueRequest(Wheels(*[min(max(m, -most), most) for m in request.drive]), request.brake)
