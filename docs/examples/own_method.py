"""Your own method of the node asr: limit the drive torque of every wheel. The law of own_node.py, without ROS."""

from dataclasses import dataclass

from ev_core.law import Vehicle, Wheels, WheelTorqueCommand, WheelTorqueRequest, method, parameter


@dataclass(frozen=True, slots=True)
class LimitParameters:
    """What can be set by --set asr.limit=..., by a parameter file or by `ros2 param set`."""

    limit: float = parameter(
        1000.0, unit="N m", low=0.0, high=10000.0, about="largest drive torque of a wheel"
    )


@method("asr", "limit")
class Limit:
    """Limit the drive torque of every wheel."""

    parameters = LimitParameters
    state = None  # nothing lasts between steps
    mirrored = True  # left and right are alike to it

    def __init__(self, parameters: LimitParameters, vehicle: Vehicle, period: float) -> None:
        self._limit = parameters.limit

    def step(self, request: WheelTorqueRequest) -> WheelTorqueCommand:
        """The same torques [N m], those of the drives limited."""
        return WheelTorqueCommand(
            Wheels(*(min(torque, self._limit) for torque in request.drive)), request.brake
        )
