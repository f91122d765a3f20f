"""The steering wheel sets the torque difference of two front drives, and nothing else (Shchur 2019)."""

from __future__ import annotations

from dataclasses import dataclass
from types import MappingProxyType

from ev_control.electronic_differential.torque_split import (
    BrakeSplitParameters,
    TorqueSplit,
    require_driven_front_wheels,
)
from ev_msgs_py.methods import method
from ev_msgs_py.parameters import group, parameter
from ev_msgs_py.signals import DriverCommand, SteeringColumnState, WheelTorqueRequest
from ev_msgs_py.vehicle import Vehicle


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


@method("electronic_differential", "drive_by_wire")
class DriveByWire:
    """Set the torque difference of the front wheels in proportion to the steering-wheel angle, without feedback.

    Delta M = M_R - M_L = k alpha, left positive: the drive-by-wire concept in the introduction of Shchur (2019), for a
    by_wire steering column. ValueError unless both front wheels are driven.
    """

    parameters = DriveByWireParameters
    requires = MappingProxyType({"steering_column": "by_wire"})  # the hands must not turn the road wheels as well
    state = None  # nothing lasts between steps

    def __init__(self, parameters: DriveByWireParameters, vehicle: Vehicle, period: float) -> None:
        require_driven_front_wheels(vehicle, "drive_by_wire")
        self._gain = parameters.gain
        self._split = TorqueSplit(parameters.brake, vehicle)

    def step(self, driver: DriverCommand, column: SteeringColumnState) -> WheelTorqueRequest:
        """Equal wheel torques [N m] with a difference in proportion to the steering-wheel angle."""
        return self._split.request(driver, self._gain * column.angle)
