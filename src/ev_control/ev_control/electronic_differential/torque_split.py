"""What every electronic differential starts from: equal drive torques, plus a difference of the front wheels.

The difference is the paper's Delta M = M_R - M_L, right minus left: positive turns the car and the front wheels to
the left (Shchur 2019, eqs 1 to 4).
"""

from __future__ import annotations

from dataclasses import dataclass

from ev_msgs_py.car import Car
from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.parameters import parameter
from ev_msgs_py.signals import DriverCommand, WheelTorqueRequest
from ev_msgs_py.vehicle import Vehicle
from ev_msgs_py.wheels import NO_WHEELS, WHEEL_NAMES, Wheels


@dataclass(frozen=True, slots=True)
class BrakeSplitParameters:
    """How the brake torque of the driver is distributed."""

    front_share: float = parameter(
        0.6, unit="1", low=0.0, high=1.0, about="share of the brake torque on the front axle", source="assumption"
    )


@compilable
def split(brake: BrakeSplitParameters, car: Car, driver: DriverCommand, difference: float) -> WheelTorqueRequest:
    """Wheel torques [N m]: equal over the driven wheels, with a difference of the front ones, right minus left.

    The drive torques add up to what the driver asks for; the brake torque goes to all four wheels.
    """
    equal, half = driver.drive_torque / car.number_driven, difference / 2.0
    drive = Wheels(
        equal - half if car.driven[0] == 1.0 else 0.0,
        equal + half if car.driven[1] == 1.0 else 0.0,
        equal if car.driven[2] == 1.0 else 0.0,
        equal if car.driven[3] == 1.0 else 0.0,
    )
    return WheelTorqueRequest(drive, split_brake(brake, driver))


@compilable
def split_brake(brake: BrakeSplitParameters, driver: DriverCommand) -> Wheels:
    """The driver's brake torque over the four wheels [N m]."""
    if driver.brake_torque == 0.0:
        return NO_WHEELS
    front = driver.brake_torque * brake.front_share / 2.0
    rear = driver.brake_torque / 2.0 - front
    return Wheels(front, front, rear, rear)


class TorqueSplit:
    """Split the driver's torques: the drive torque equally over the driven wheels, the brake torque over all four.

    The drive torques always add up to what the driver asks for. Raises ValueError if no wheel is driven.
    """

    def __init__(self, brake: BrakeSplitParameters, vehicle: Vehicle) -> None:
        self._driven = tuple(name in vehicle.driven_wheels for name in WHEEL_NAMES)
        self._number_driven = sum(self._driven)
        self._front_share = brake.front_share
        if not self._number_driven:
            raise ValueError(f"vehicle {vehicle.name} has no driven wheels, at least one is needed")

    def request(self, driver: DriverCommand, difference: float = 0.0) -> WheelTorqueRequest:
        """Wheel torques [N m] with a difference [N m] of the front wheels, right minus left."""
        equal, half = driver.drive_torque / self._number_driven, difference / 2
        front_left, front_right, rear_left, rear_right = self._driven
        drive = Wheels(
            equal - half if front_left else 0.0,
            equal + half if front_right else 0.0,
            equal if rear_left else 0.0,
            equal if rear_right else 0.0,
        )
        if driver.brake_torque == 0.0:
            return WheelTorqueRequest(drive)
        front_brake = driver.brake_torque * self._front_share / 2
        rear_brake = driver.brake_torque / 2 - front_brake
        return WheelTorqueRequest(drive, Wheels(front_brake, front_brake, rear_brake, rear_brake))


def require_driven_wheels(vehicle: Vehicle, law: str, needed: tuple[str, ...]) -> None:
    """ValueError, in the name of a law, unless all the needed wheels are driven."""
    if not set(needed) <= set(vehicle.driven_wheels):
        raise ValueError(
            f"electronic_differential {law} needs {', '.join(needed[:-1])} and {needed[-1]} among the driven wheels,"
            f" vehicle {vehicle.name} drives {', '.join(vehicle.driven_wheels) or 'none'}"
        )


def require_driven_front_wheels(vehicle: Vehicle, law: str) -> None:
    """ValueError, in the name of a law, unless both front wheels are driven."""
    require_driven_wheels(vehicle, law, ("front_left", "front_right"))


@compilable
def torque_difference_per_steering_moment(vehicle: Car | Vehicle) -> float:
    """Difference of the front wheel torques that turns the road wheels with 1 N m: 2 r_k/d (Shchur 2019, eq 3)."""
    return 2 * vehicle.wheel_radius / vehicle.front_track
