"""The law of the source: the outer front wheel gets more torque, in proportion to the steering angle."""

from dataclasses import dataclass

from ev_control.law import BrakeSplitParameters, split
from ev_core.law import (
    FRONT_WHEELS_DRIVEN,
    Car,
    DriverCommand,
    SteeringColumnState,
    WheelTorqueRequest,
    compilable,
    group,
    method,
    parameter,
)


@dataclass(frozen=True, slots=True)
class OuterWheelParameters:
    """What can be set by --set electronic_differential.gain=..., or by a parameter file."""

    gain: float = parameter(
        2000.0, unit="N m/rad", low=0.0, high=1e5, about="K of eq 1", source="the source, table 1"
    )
    brake: BrakeSplitParameters = group(BrakeSplitParameters)


@method("electronic_differential", "outer_wheel", needs=(FRONT_WHEELS_DRIVEN,), mirrored=True)
@compilable
def outer_wheel(
    p: OuterWheelParameters, car: Car, driver: DriverCommand, column: SteeringColumnState
) -> WheelTorqueRequest:
    """M_right - M_left = K delta (eq 1); delta is the road-wheel angle, left positive."""
    return split(p.brake, car, driver, p.gain * column.road_wheel_angle)
