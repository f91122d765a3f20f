"""The speed that slip is counted against: what every wheel would turn at if it rolled."""

from __future__ import annotations

from dataclasses import dataclass
from operator import attrgetter
from typing import Any

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.contract.record import entry
from ev_msgs_py.contract.signals import InertialMeasurement
from ev_msgs_py.contract.wheels import WHEEL_NAMES, Wheels
from ev_msgs_py.elementary import cos, sin
from ev_msgs_py.parameters.declaration import parameter
from ev_msgs_py.vehicle.car import Car
from ev_msgs_py.vehicle.description import Vehicle
from ev_msgs_py.vehicle.layout import Need

SOURCES = ("automatic", "free_wheels", "observer")
AUTOMATIC, FREE_WHEELS, OBSERVER = range(len(SOURCES))


@dataclass(frozen=True, slots=True)
class ReferenceSpeedParameters:
    """Where the speed of the car comes from, and how far wheels and accelerometer are believed."""

    source: str = parameter(
        "automatic",
        choices=SOURCES,
        about="free_wheels: wheels without a motor; observer: acceleration, corrected by the wheels; automatic: free "
        "wheels where the car has any",
        source="dissertation, eq 2.34, has free wheels; the observer is an assumption",
    )
    gripping_rate: float = parameter(
        20.0,
        unit="1/s",
        low=0.0,
        high=1000.0,
        about="correction of the observer by a wheel that cannot be slipping",
        source="assumption",
    )
    slipping_rate: float = parameter(
        0.5,
        unit="1/s",
        low=0.0,
        high=1000.0,
        about="correction of the observer by wheels that may be slipping; bounds what a sensor's offset adds up to",
        source="assumption",
    )


@dataclass(slots=True)
class ReferenceSpeedState:
    """What lasts between steps."""

    speed: float = entry(unit="m/s", about="estimated speed of the car along its axis, negative in reverse")


def free_wheels_for(group: str) -> Need:
    """A wheel must roll without a motor where the reference speed whose parameters are this group asks for one."""

    def lacks(parameters: Any, vehicle: Vehicle) -> str:
        if attrgetter(group)(parameters).source != "free_wheels" or set(WHEEL_NAMES) - set(vehicle.driven_wheels):
            return ""
        return f"a wheel without a motor for {group}.source free_wheels"

    return lacks


@compilable
def rolling_speeds(
    p: ReferenceSpeedParameters,
    car: Car,
    s: ReferenceSpeedState,
    period: float,
    velocity: Wheels,
    road_wheel_angle: float,
    imu: InertialMeasurement,
    direction: float,
) -> Wheels:
    """Speeds [rad/s] at which the wheels would roll in the bend that the car drives.

    The middle of the rear axle is taken to move straight ahead. Left wheels then move at u - r t/2 and right ones at
    u + r t/2 along the car (track t, yaw rate r), and steered ones at (u -+ r t/2) cos(delta) + L r sin(delta) along
    themselves. `free_wheels` turns this round and takes the mean of the wheels without a motor, which roll as long as
    nobody brakes; `observer` see `observed_speed`. `velocity` are wheel speeds [rad/s], the angle is that of the road
    wheels [rad], within -pi/2..pi/2, `direction` the sign of what the drives are asked for.
    """
    r, radius = imu.yaw_rate, car.wheel_radius
    cosine, across = cos(road_wheel_angle), car.wheelbase * r * sin(road_wheel_angle)
    front, rear = r * (car.front_track / 2.0), r * (car.rear_track / 2.0)
    by_wheel = Wheels(
        (velocity.front_left * radius - across) / cosine + front,
        (velocity.front_right * radius - across) / cosine - front,
        velocity.rear_left * radius + rear,
        velocity.rear_right * radius - rear,
    )
    if p.source == OBSERVER or car.number_driven == 4.0:
        s.speed = observed_speed(p, s, period, by_wheel, imu.longitudinal_acceleration, direction)
    else:
        s.speed = mean_of_free_wheels(car, by_wheel)
    u = s.speed
    return Wheels(
        ((u - front) * cosine + across) / radius,
        ((u + front) * cosine + across) / radius,
        (u - rear) / radius,
        (u + rear) / radius,
    )


@compilable
def mean_of_free_wheels(car: Car, by_wheel: Wheels) -> float:
    """Speed of the car [m/s] by the wheels without a motor; there must be one."""
    front = (1.0 - car.driven[0]) * by_wheel[0] + (1.0 - car.driven[1]) * by_wheel[1]
    rear = (1.0 - car.driven[2]) * by_wheel[2] + (1.0 - car.driven[3]) * by_wheel[3]
    return (front + rear) / (4.0 - car.number_driven)


@compilable
def observed_speed(
    p: ReferenceSpeedParameters,
    s: ReferenceSpeedState,
    period: float,
    by_wheel: Wheels,
    acceleration: float,
    direction: float,
) -> float:
    """Speed of the car [m/s] by its acceleration [m/s^2], corrected by what each wheel would mean if it rolled [m/s].

    A wheel that is driven never turns slower than it would roll, a braked one never faster: so the slowest wheel
    (braking: the fastest) limits the estimate quickly (`gripping_rate`) and otherwise only draws it slowly
    (`slipping_rate`), because all wheels may be slipping.
    """
    u = s.speed + acceleration * period
    slowest = min(by_wheel[0], by_wheel[1], by_wheel[2], by_wheel[3])
    fastest = max(by_wheel[0], by_wheel[1], by_wheel[2], by_wheel[3])
    if direction == 0.0:
        gap = (slowest + fastest) / 2.0 - u  # wheels without torque roll
        return u + gap * min(p.gripping_rate * period, 1.0)
    gap = (slowest if direction > 0.0 else fastest) - u
    rate = p.gripping_rate if gap * direction < 0.0 else p.slipping_rate
    return u + gap * min(rate * period, 1.0)
