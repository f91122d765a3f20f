"""Yaw moment by opposite changes of torques left and right, shared by the axles by a rule."""

from dataclasses import dataclass
from typing import Any

from ev_control.estimation.wheel_dynamics import wheel_loads
from ev_control.shared.allocation import motor_range
from ev_core.law import Car, InertialMeasurement, Vehicle, Wheels, compilable, parameter
from ev_core.vehicle.driveline import has_own_motors


@dataclass(frozen=True, slots=True)
class ShareParameters:
    """Shares of the axles in a moment where both can give it."""

    front: float = parameter(
        0.5, unit="1", low=0.0, high=1.0, about="share of the front axle in the yaw moment"
    )


def an_axle_with_motors(_parameters: Any, vehicle: Vehicle) -> str:
    """Both wheels of one axle need motors of their own."""
    axles = ({"front_left", "front_right"}, {"rear_left", "rear_right"})
    own = has_own_motors(vehicle) and vehicle.engine.peak_power == 0.0
    if own and any(axle <= set(vehicle.driven_wheels) for axle in axles):
        return ""
    return "a motor for each wheel of an axle, and no others"


@compilable
def can_turn(car: Car, front: bool) -> bool:
    """Return true if both wheels of an axle are driven."""
    both = car.driven[0] * car.driven[1] if front else car.driven[2] * car.driven[3]
    return both == 1.0


@compilable
def by_axle(p: ShareParameters, car: Car, total: float, moment: float) -> Wheels:
    """Equal torques of all driven wheels, and a fixed share of the moment on each axle [N m]."""
    share, equal = p.front, total / car.number_driven
    # An axle without two motors cannot turn the car: the other one gives all of the moment.
    if not can_turn(car, True):
        share = 0.0
    elif not can_turn(car, False):
        share = 1.0
    front = turning(car.front_track, car, share * moment)
    rear = turning(car.rear_track, car, (1.0 - share) * moment)
    return Wheels(
        car.driven[0] * (equal - front),
        car.driven[1] * (equal + front),
        car.driven[2] * (equal - rear),
        car.driven[3] * (equal + rear),
    )


@compilable
def by_load(car: Car, imu: InertialMeasurement, total: float, moment: float) -> Wheels:
    """Torques by the load of each driven wheel, and the moment by that of each axle [N m]."""
    load = wheel_loads(car, imu)
    a, b = car.driven[0] * load[0], car.driven[1] * load[1]
    c, d = car.driven[2] * load[2], car.driven[3] * load[3]
    front = a + b if can_turn(car, True) else 0.0
    rear = c + d if can_turn(car, False) else 0.0
    # Torque per load.
    along = total / ((a + b) + (c + d))
    in_front = turning(car.front_track, car, moment * front / (front + rear))
    behind = turning(car.rear_track, car, moment * rear / (front + rear))
    return Wheels(
        along * a - in_front, along * b + in_front, along * c - behind, along * d + behind
    )


@compilable
def turning(track: float, car: Car, moment: float) -> float:
    """Half the torque difference of an axle [N m] that turns the car with a moment [N m]."""
    return moment * car.wheel_radius / track


@compilable
def motors_turn(car: Car, speed: Wheels) -> float:
    """Yaw moment [N m] that all motors can give either way, at wheel speeds [rad/s]."""
    a = motor_range(car, 0, speed[0])
    b = motor_range(car, 1, speed[1])
    c = motor_range(car, 2, speed[2])
    d = motor_range(car, 3, speed[3])
    # Either way: each wheel has to drive as well as to brake with this torque.
    front = min(min(a.most, -a.least), min(b.most, -b.least)) * car.front_track
    rear = min(min(c.most, -c.least), min(d.most, -d.least)) * car.rear_track
    return (front + rear) / car.wheel_radius


@compilable
def turned_by(car: Car, drive: Wheels) -> float:
    """The yaw moment of drive torques [N m]; the steering angle is taken as small."""
    front, rear = car.front_track / 2.0, car.rear_track / 2.0
    return ((drive[1] - drive[0]) * front + (drive[3] - drive[2]) * rear) / car.wheel_radius
