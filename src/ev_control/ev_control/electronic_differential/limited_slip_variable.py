"""A differential whose locking grows with the speed difference, method 4 of the dissertation's five."""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.law import AllocationParameters, BrakeSplitParameters, allocated, own_motors_to_allocate, split
from ev_control.shared.torque_split import locked, locking_share
from ev_core.law import Car, compilable, each_driven, group, method, parameter
from ev_msgs_py.contract.signals import DriverCommand, WheelStates, WheelTorqueRequest


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
    allocation: AllocationParameters = group(AllocationParameters)


@method(
    "electronic_differential",
    "limited_slip_variable",
    LimitedSlipVariableParameters,
    needs=(each_driven, own_motors_to_allocate),
    mirrored=True,
)
@compilable
def limited_slip_variable(
    p: LimitedSlipVariableParameters, car: Car, driver: DriverCommand, wheels: WheelStates
) -> WheelTorqueRequest:
    """Give the slower wheel of each driven axle up to K times the torque of the faster one, as their speeds differ.

    M_slow/M_fast = 1 + (K - 1) min(|d|/d_full, 1) with the difference d of the wheel speeds [rad/s] and K = 1.5
    (dissertation, section 3.4); the sum of the torques [N m] is the driver's.
    """
    equal, speed = split(p.brake, car, driver, 0.0), wheels.velocity
    front = signed_share(p, speed.front_left - speed.front_right)
    rear = signed_share(p, speed.rear_left - speed.rear_right)
    drive = locked(car, equal.drive, front, rear)
    return allocated(p.allocation, car, wheels, WheelTorqueRequest(drive, equal.brake))


@compilable
def signed_share(p: LimitedSlipVariableParameters, difference: float) -> float:
    """(K - 1)/(K + 1) at a difference of the wheel speeds [rad/s], with its sign [1]."""
    rise = p.largest_locking_ratio - 1.0
    share = locking_share(1.0 + rise * min(abs(difference) / p.full_locking_speed, 1.0))
    return share if difference >= 0.0 else -share
