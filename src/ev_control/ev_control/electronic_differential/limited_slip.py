"""A differential with constant locking, method 3 of the dissertation's five."""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.law import AllocationParameters, BrakeSplitParameters, allocated, own_motors_to_allocate, split
from ev_control.shared.torque_split import locked, locking_share
from ev_core.law import Car, compilable, each_driven, group, method, parameter, tanh
from ev_msgs_py.contract.signals import DriverCommand, WheelStates, WheelTorqueRequest


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
    allocation: AllocationParameters = group(AllocationParameters)


@method(
    "electronic_differential",
    "limited_slip",
    LimitedSlipParameters,
    needs=(each_driven, own_motors_to_allocate),
    mirrored=True,
)
@compilable
def limited_slip(p: LimitedSlipParameters, car: Car, driver: DriverCommand, wheels: WheelStates) -> WheelTorqueRequest:
    """Give the slower wheel of each driven axle K times the torque of the faster one.

    M_slow/M_fast = K = 1.5 (dissertation, section 3.3), smoothed by tanh of the difference of the wheel speeds
    [rad/s]; the sum of the torques [N m] is the driver's.
    """
    equal, most, speed = split(p.brake, car, driver, 0.0), locking_share(p.locking_ratio), wheels.velocity
    front = most * tanh((speed.front_left - speed.front_right) / p.locking_speed)
    rear = most * tanh((speed.rear_left - speed.rear_right) / p.locking_speed)
    drive = locked(car, equal.drive, front, rear)
    return allocated(p.allocation, car, wheels, WheelTorqueRequest(drive, equal.brake))
