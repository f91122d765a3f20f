"""What every electronic differential starts from: equal drive torques, plus a difference of the front wheels.

The difference is the paper's Delta M = M_R - M_L, right minus left: positive turns the car and the front wheels to
the left (Shchur 2019, eqs 1 to 4).
"""

from __future__ import annotations

from dataclasses import dataclass

from ev_core.law import NO_WHEELS, Car, DriverCommand, Wheels, WheelTorqueRequest, compilable, parameter


@compilable
def locking_share(ratio: float) -> float:
    """(K - 1)/(K + 1): locking torque over the torque of the axle [1], for a ratio K of at least 1."""
    return (ratio - 1.0) / (ratio + 1.0)


@compilable
def locked(car: Car, drive: Wheels, front_share: float, rear_share: float) -> Wheels:
    """The drive torques [N m] after locking of every axle of which both wheels are driven; the sums stay.

    M_slow - M_fast = (K - 1)/(K + 1) |M_slow + M_fast|, so M_slow/M_fast = K in traction (dissertation, section 1.2:
    K is the locking coefficient). The shares of the axles are (K - 1)/(K + 1) with the sign of w_left - w_right.
    """
    front, rear = 0.0, 0.0
    if car.driven[0] == 1.0 and car.driven[1] == 1.0:
        front = abs(drive[0] + drive[1]) / 2.0 * front_share
    if car.driven[2] == 1.0 and car.driven[3] == 1.0:
        rear = abs(drive[2] + drive[3]) / 2.0 * rear_share
    return Wheels(drive[0] - front, drive[1] + front, drive[2] - rear, drive[3] + rear)


@dataclass(frozen=True, slots=True)
class BrakeSplitParameters:
    """How the brake torque of the driver is distributed."""

    front_share: float = parameter(
        0.6, unit="1", low=0.0, high=1.0, about="share of the brake torque on the front axle"
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


@compilable
def torque_difference_per_steering_moment(car: Car) -> float:
    """Difference of the front wheel torques that turns the road wheels with 1 N m: 2 r_k/d (Shchur 2019, eq 3)."""
    return 2.0 * car.wheel_radius / car.front_track
