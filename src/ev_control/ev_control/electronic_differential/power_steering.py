"""Power steering by the torque difference of two front drives (Shchur 2019, eq 4)."""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.law import AllocationParameters, BrakeSplitParameters, allocated, own_motors_to_allocate, split
from ev_control.shared.assistance import AssistanceParameters, assistance
from ev_control.shared.torque_split import torque_difference_per_steering_moment
from ev_core.law import FRONT_WHEELS_DRIVEN, Car, compilable, group, method
from ev_msgs_py.contract.signals import DriverCommand, SteeringColumnState, WheelStates, WheelTorqueRequest


@dataclass(frozen=True, slots=True)
class PowerSteeringParameters(AssistanceParameters):
    """Assistance and the virtual spring and damper, all at the steering wheel."""

    brake: BrakeSplitParameters = group(BrakeSplitParameters)
    allocation: AllocationParameters = group(AllocationParameters)


@method(
    "electronic_differential",
    "power_steering",
    PowerSteeringParameters,
    needs=(FRONT_WHEELS_DRIVEN, own_motors_to_allocate),
    mirrored=True,
)
@compilable
def power_steering(
    p: PowerSteeringParameters, car: Car, driver: DriverCommand, column: SteeringColumnState, wheels: WheelStates
) -> WheelTorqueRequest:
    """Split the drive torque so that the difference of the front wheels assists and damps the steering.

    Delta M = M_R - M_L = (2 r_k i / d) (gamma M_b - k_ck alpha - b_ck alpha'), with the hand torque M_b [N m] and the
    steering-wheel angle alpha [rad] as the column measures them, left positive. Shchur (2019), eq 4.
    """
    lever = torque_difference_per_steering_moment(car) * car.steering_ratio
    difference = lever * assistance(p, column)
    return allocated(p.allocation, car, wheels, split(p.brake, car, driver, difference))
