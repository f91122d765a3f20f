"""Start of every electronic differential: equal drive torques, plus a difference in front.

The difference is the paper's Delta M = M_R - M_L, right minus left: positive turns the car and the
front wheels to the left (Shchur 2019, eqs 1 to 4). By such a difference two front drives assist the
hands (eq 4).
"""

from dataclasses import dataclass
from enum import auto
from functools import partial

from ev_core.law import (
    NO_WHEELS,
    Car,
    Choice,
    DriverCommand,
    SteeringColumnState,
    Wheels,
    WheelTorqueRequest,
    compilable,
    method,
    parameter,
)

# The method of an electronic differential: left and right are alike to all of them.
differential = partial(method, "electronic_differential", mirrored=True)


class KnownBy(Choice):
    """Source of what no sensor of a car measures: the plant itself, or an estimate."""

    TRUTH = auto()
    ESTIMATED = auto()


@dataclass(frozen=True, slots=True)
class BrakeSplitParameters:
    """Distribution of the driver's brake torque."""

    front_share: float = parameter(
        0.6, unit="1", low=0.0, high=1.0, about="share of the brake torque on the front axle"
    )


@compilable
def split(
    brake: BrakeSplitParameters, car: Car, driver: DriverCommand, difference: float
) -> WheelTorqueRequest:
    """Wheel torques [N m]: equal over the driven wheels, with a difference in front.

    The drive torques add up to what the driver asks for; the brake torque goes to all four wheels.
    """
    # Half less on the left and half more on the right: the sum stays that of the driver.
    equal, half = driver.drive_torque / car.number_driven, difference / 2.0
    drive = Wheels(
        equal - half if car.driven[0] else 0.0,
        equal + half if car.driven[1] else 0.0,
        equal if car.driven[2] else 0.0,
        equal if car.driven[3] else 0.0,
    )
    return WheelTorqueRequest(drive, split_brake(brake, driver))


@compilable
def split_brake(brake: BrakeSplitParameters, driver: DriverCommand) -> Wheels:
    """Brake torque of the driver over the four wheels [N m]."""
    if driver.brake_torque == 0.0:
        return NO_WHEELS
    front = driver.brake_torque * brake.front_share / 2.0
    rear = driver.brake_torque / 2.0 - front
    return Wheels(front, front, rear, rear)


@compilable
def torque_difference_per_steering_moment(car: Car) -> float:
    """Difference of front torques per moment on the road wheels: 2 r_k/d (Shchur 2019, eq 3)."""
    return 2.0 * car.wheel_radius / car.front_track


@dataclass(frozen=True, slots=True)
class AssistanceParameters:
    """Assistance and the virtual spring and damper, all at the steering wheel."""

    gamma: float = parameter(
        5.0,
        unit="1",
        low=0.0,
        high=50.0,
        about="amplification of the hand torque",
        source="Shchur 2019, fig. 1",
    )
    k_ck: float = parameter(
        0.051,
        unit="N m/rad",
        low=0.0,
        high=10.0,
        about="stiffness of the virtual spring",
        source="Shchur 2019, eq 7",
    )
    b_ck: float = parameter(
        0.062,
        unit="N m s/rad",
        low=0.0,
        high=10.0,
        about="virtual damping",
        source="Shchur 2019, eq 7",
    )


@compilable
def assistance(p: AssistanceParameters, column: SteeringColumnState) -> float:
    """Torque at the steering wheel [N m] besides the hands' (eq 4)."""
    return p.gamma * column.hand_torque - p.k_ck * column.angle - p.b_ck * column.rate
