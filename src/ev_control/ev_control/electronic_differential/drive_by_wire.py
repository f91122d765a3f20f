"""The steering wheel sets the torque difference of two front drives, and nothing else (Shchur 2019)."""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.law import AllocationParameters, BrakeSplitParameters, allocated, own_motors_to_allocate, split
from ev_core.law import FRONT_WHEELS_DRIVEN, Car, compilable, group, method, parameter
from ev_msgs_py.contract.signals import DriverCommand, SteeringColumnState, WheelStates, WheelTorqueRequest


@dataclass(frozen=True, slots=True)
class DriveByWireParameters:
    """The gain from steering-wheel angle to torque difference."""

    gain: float = parameter(
        1.634,
        unit="N m/rad",
        low=0.0,
        high=1000.0,
        about="torque difference per steering-wheel angle; 2 r_k k_p/(d i) settles the paper's car at alpha/i",
        source="assumption, from Shchur 2019, eq 3 at rest with M_b = 0",
    )
    brake: BrakeSplitParameters = group(BrakeSplitParameters)
    allocation: AllocationParameters = group(AllocationParameters)


@method(
    "electronic_differential",
    "drive_by_wire",
    DriveByWireParameters,
    needs=(FRONT_WHEELS_DRIVEN, own_motors_to_allocate),
    requires={"steering_column": "by_wire"},  # the hands must not turn the road wheels as well,
    mirrored=True,
)
@compilable
def drive_by_wire(
    p: DriveByWireParameters, car: Car, driver: DriverCommand, column: SteeringColumnState, wheels: WheelStates
) -> WheelTorqueRequest:
    """Set the torque difference of the front wheels in proportion to the steering-wheel angle, without feedback.

    Delta M = M_R - M_L = k alpha [N m], left positive: the drive-by-wire concept in the introduction of Shchur (2019),
    for a by_wire steering column.
    """
    return allocated(p.allocation, car, wheels, split(p.brake, car, driver, p.gain * column.angle))
