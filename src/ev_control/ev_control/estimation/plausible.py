"""Wheel loads of a rigid car from its accelerations, and what no road vehicle does, so that no sensor is believed."""

from __future__ import annotations

from ev_core.law import GRAVITY, Car, InertialMeasurement, SteeringColumnState, WheelStates, compilable
from ev_msgs_py.contract.wheels import FRONT_LEFT, FRONT_RIGHT, REAR_LEFT, REAR_RIGHT, Wheels


@compilable
def wheel_load(car: Car, wheel: int, longitudinal_acceleration: float, lateral_acceleration: float) -> float:
    """Load of a wheel [N] by its place in Wheels and the accelerations of the car to its front and left [m/s^2].

    F_z = m (g b/L -+ h a_x/L)/2 -+ k h m a_y/t, with the front (b: rear) arm of the centre of mass. Dissertation,
    eqs 2.28 to 2.31, for a centre of mass in the car's middle; k is the axle's share of the roll moment. Never below a
    tenth of the load at rest, where the car would be on three wheels.
    """
    half_mass = car.mass / 2.0
    along = half_mass * car.pitch_height / car.wheelbase * longitudinal_acceleration
    front = wheel in (FRONT_LEFT, FRONT_RIGHT)
    roll, track = (car.front_roll_share, car.front_track) if front else (1.0 - car.front_roll_share, car.rear_track)
    across = 2.0 * half_mass * car.roll_height * roll / track * lateral_acceleration
    at_rest = load_at_rest(car, wheel)
    load = at_rest - along if front else at_rest + along
    load = load - across if wheel in (FRONT_LEFT, REAR_LEFT) else load + across
    return max(load, 0.1 * at_rest)


@compilable
def load_at_rest(car: Car, wheel: int) -> float:
    """Load of a wheel of the car at rest [N]."""
    front = car.centre_of_mass_to_rear_axle / car.wheelbase
    share = front if wheel in (FRONT_LEFT, FRONT_RIGHT) else 1.0 - front
    return car.mass / 2.0 * GRAVITY * share


@compilable
def wheel_loads(car: Car, imu: InertialMeasurement) -> Wheels:
    """Loads of all wheels [N]."""
    a_x, a_y = imu.longitudinal_acceleration, imu.lateral_acceleration
    return Wheels(
        wheel_load(car, FRONT_LEFT, a_x, a_y),
        wheel_load(car, FRONT_RIGHT, a_x, a_y),
        wheel_load(car, REAR_LEFT, a_x, a_y),
        wheel_load(car, REAR_RIGHT, a_x, a_y),
    )


# Beyond these a number is no measurement of a road vehicle: 3 km/s at the tyre, a hundred motors, a collision.
LARGEST_SPEED = 1e4  # [rad/s]
LARGEST_TORQUE = 1e6  # [N m]
LARGEST_ACCELERATION = 1e3  # [m/s^2]
LARGEST_YAW_RATE = 1e2  # [rad/s]
LARGEST_ANGLE = 1.5  # [rad]


@compilable
def is_plausible(column: SteeringColumnState, wheels: WheelStates, imu: InertialMeasurement) -> bool:
    """Whether all that is measured is finite and could be a road vehicle's."""
    along, across = imu.longitudinal_acceleration, imu.lateral_acceleration
    return (
        sum_of_squares(wheels.velocity) < LARGEST_SPEED * LARGEST_SPEED
        and sum_of_squares(wheels.effort) < LARGEST_TORQUE * LARGEST_TORQUE
        and along * along + across * across < LARGEST_ACCELERATION * LARGEST_ACCELERATION
        and abs(imu.yaw_rate) < LARGEST_YAW_RATE
        and abs(column.road_wheel_angle) < LARGEST_ANGLE
    )


@compilable
def sum_of_squares(of: Wheels) -> float:
    """Left and right first, so that a mirrored car gets the same number."""
    return (of[0] * of[0] + of[1] * of[1]) + (of[2] * of[2] + of[3] * of[3])
