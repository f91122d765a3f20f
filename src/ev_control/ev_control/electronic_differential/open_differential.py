"""The free symmetric differential, method 2 of the dissertation's five."""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.law import BrakeSplitParameters, split
from ev_core.law import Car, DriverCommand, WheelTorqueRequest, any_driven, compilable, equal_motors, group, method
from ev_msgs_py.contract.wheels import Wheels


@dataclass(frozen=True, slots=True)
class OpenDifferentialParameters:
    """Only the brakes leave a choice: the differential has no friction."""

    brake: BrakeSplitParameters = group(BrakeSplitParameters)


@method(
    "electronic_differential",
    "open_differential",
    OpenDifferentialParameters,
    needs=(any_driven, equal_motors),
    mirrored=True,
)
@compilable
def open_differential(p: OpenDifferentialParameters, car: Car, driver: DriverCommand) -> WheelTorqueRequest:
    """Equal torques left and right as behind a mechanical differential, whose wheels cannot get more than both grip.

    M_left = M_right = M_axle/2 [N m] (dissertation, section 3.2), the torques of the axles alike, none above what one
    motor has. Other than `equal_torque` the drive is one whole: what one wheel of an axle does not deliver, because of
    its motor, the other one does not get either, as no gear could give it.
    """
    equal, most = split(p.brake, car, driver, 0.0), car.motor.peak_torque * car.gear_ratio
    m = equal.drive
    drive = Wheels(
        min(max(m.front_left, -most), most),
        min(max(m.front_right, -most), most),
        min(max(m.rear_left, -most), most),
        min(max(m.rear_right, -most), most),
    )
    return WheelTorqueRequest(drive, equal.brake)
