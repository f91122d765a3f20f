"""More torque for the outer wheel of one axle, in proportion to the steering angle (Tatar & Chudzik)."""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.electronic_differential.torque_split import BrakeSplitParameters, TorqueSplit, require_driven_wheels
from ev_msgs_py.methods import method
from ev_msgs_py.parameters import group, parameter
from ev_msgs_py.signals import DriverCommand, SteeringColumnState, WheelTorqueRequest
from ev_msgs_py.vehicle import Vehicle


@dataclass(frozen=True, slots=True)
class SteeringCorrectionParameters:
    """Which axle is corrected and by how much; the source gives neither gain nor limit."""

    axle: str = parameter(
        "automatic",
        choices=("automatic", "front", "rear"),
        about="axle whose torques differ; automatic: the front axle if both its wheels are driven, else the rear axle",
        source="Tatar & Chudzik: front of front and all-wheel drive, rear of rear drive",
    )
    gain: float = parameter(
        1.5915494309189535,
        unit="1/rad",
        low=0.0,
        high=20.0,
        about="change of each wheel's torque over its equal share, per road-wheel angle; the default is 50 % at pi/10",
        source="assumption",
    )
    largest_correction: float = parameter(
        1.0,
        unit="1",
        low=0.0,
        high=1.0,
        about="limit of the change over the equal share; 1 takes all torque from the inner wheel",
        source="assumption",
    )
    brake: BrakeSplitParameters = group(BrakeSplitParameters)


@method("electronic_differential", "steering_correction")
class SteeringCorrection:
    """Move drive torque from the inner to the outer wheel of one axle in proportion to the road-wheel angle.

    T_left = T (1 - c), T_right = T (1 + c), c = gain delta within +-largest_correction, with the equal share T [N m]
    and the mean road-wheel angle delta [rad], left positive. The sum is the driver's; a negative torque is shared in
    the same proportion, and then turns the car out of the bend (assumption). Tatar & Chudzik, who describe the
    correction in words only. ValueError unless both wheels of the axle are driven.
    """

    parameters = SteeringCorrectionParameters
    state = None  # nothing lasts between steps

    def __init__(self, parameters: SteeringCorrectionParameters, vehicle: Vehicle, period: float) -> None:
        front_driven = {"front_left", "front_right"} <= set(vehicle.driven_wheels)
        self._front = parameters.axle == "front" or (parameters.axle == "automatic" and front_driven)
        needed = ("front_left", "front_right") if self._front else ("rear_left", "rear_right")
        require_driven_wheels(vehicle, "steering_correction", needed)
        self._p = parameters
        self._split = TorqueSplit(parameters.brake, vehicle)

    def step(self, driver: DriverCommand, column: SteeringColumnState) -> WheelTorqueRequest:
        """Equal wheel torques [N m] but for the corrected axle."""
        p = self._p
        correction = min(max(p.gain * column.road_wheel_angle, -p.largest_correction), p.largest_correction)
        equal = self._split.request(driver)
        share = equal.drive.front_left if self._front else equal.drive.rear_left
        left, right = share - share * correction, share + share * correction
        if self._front:
            drive = equal.drive._replace(front_left=left, front_right=right)
        else:
            drive = equal.drive._replace(rear_left=left, rear_right=right)
        return WheelTorqueRequest(drive, equal.brake)
