"""More torque for the outer wheel of one axle, in proportion to the steering angle (Tatar & Chudzik)."""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.law import AllocationParameters, BrakeSplitParameters, allocated, own_motors_to_allocate, split
from ev_control.shared.torque_split import differential
from ev_core.law import FRONT_WHEELS_DRIVEN, REAR_WHEELS_DRIVEN, Car, Vehicle, Wheels, compilable, group, parameter
from ev_msgs_py.contract.signals import DriverCommand, SteeringColumnState, WheelStates, WheelTorqueRequest

CORRECTED_AXLES = ("automatic", "front", "rear")
AUTOMATIC, FRONT, REAR = range(len(CORRECTED_AXLES))


@dataclass(frozen=True, slots=True)
class SteeringCorrectionParameters:
    """Which axle is corrected and by how much; the source gives neither gain nor limit."""

    axle: str = parameter(
        "automatic",
        choices=CORRECTED_AXLES,
        about="axle whose torques differ; automatic: front if both its wheels are driven, each on its own, else rear",
        source="Tatar & Chudzik: front of front and all-wheel drive, rear of rear drive",
    )
    gain: float = parameter(
        1.5915494309189535,
        unit="1/rad",
        low=0.0,
        high=20.0,
        about="change of each wheel's torque over its equal share, per road-wheel angle; the default is 50 % at pi/10",
    )
    largest_correction: float = parameter(
        1.0, unit="1", low=0.0, high=1.0, about="limit of that change; 1 takes all torque from the inner wheel"
    )
    brake: BrakeSplitParameters = group(BrakeSplitParameters)
    allocation: AllocationParameters = group(AllocationParameters)


def corrected_axle_driven(parameters: SteeringCorrectionParameters, vehicle: Vehicle) -> str:
    """Both wheels of the axle that is corrected must be driven."""
    front_lacks = FRONT_WHEELS_DRIVEN(parameters, vehicle)
    is_front = parameters.axle == "front" or (parameters.axle == "automatic" and not front_lacks)
    return front_lacks if is_front else REAR_WHEELS_DRIVEN(parameters, vehicle)


@differential(
    "steering_correction", SteeringCorrectionParameters, needs=(corrected_axle_driven, own_motors_to_allocate)
)
@compilable
def steering_correction(
    p: SteeringCorrectionParameters, car: Car, driver: DriverCommand, column: SteeringColumnState, wheels: WheelStates
) -> WheelTorqueRequest:
    """Move drive torque from the inner to the outer wheel of one axle in proportion to the road-wheel angle.

    T_left = T (1 - c), T_right = T (1 + c), c = gain delta within +-largest_correction, with the equal share T [N m]
    and the mean road-wheel angle delta [rad], left positive. The sum is the driver's; a negative torque is shared in
    the same proportion, and then turns the car out of the bend (assumption). Tatar & Chudzik, who describe the
    correction in words only.
    """
    equal = split(p.brake, car, driver, 0.0)
    correction = min(max(p.gain * column.road_wheel_angle, -p.largest_correction), p.largest_correction)
    front_left, front_right, rear_left, rear_right = equal.drive
    front_can = car.driven[0] == 1.0 and car.driven[1] == 1.0 and car.differential[0] == 0.0
    if p.axle == FRONT or (p.axle == AUTOMATIC and front_can):
        front_left, front_right = front_left - front_left * correction, front_left + front_left * correction
    else:
        rear_left, rear_right = rear_left - rear_left * correction, rear_left + rear_left * correction
    drive = Wheels(front_left, front_right, rear_left, rear_right)
    return allocated(p.allocation, car, wheels, WheelTorqueRequest(drive, equal.brake))
