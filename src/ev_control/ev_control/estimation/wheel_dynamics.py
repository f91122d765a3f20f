"""The wheel as traction control sees it: motion, slip, load, torque of the road; and filters."""

import linecache
from collections.abc import Callable, Iterator
from dataclasses import dataclass, fields, is_dataclass
from math import inf
from typing import Any, NamedTuple

from ev_core.law import GRAVITY, Car, InertialMeasurement, compilable, entry, parameter
from ev_msgs_py.contract.wheels import FRONT_LEFT, FRONT_RIGHT, REAR_LEFT, REAR_RIGHT, Wheels


def start_again(record: type) -> Callable[[Any], None]:
    """A compilable function that puts every number of a declared record back to its start value.

    Its text is made from the declaration, because compiled code reaches the fields of a record only
    by their names.
    """
    name = f"start_again_{record.__name__}"
    lines = [f"def {name}(s):\n", *(f"    {line}\n" for line in _assignments("s", record()))]
    file = f"<{name}>"
    space: dict[str, Any] = {"inf": inf, "__name__": __name__}
    linecache.cache[file] = (
        len(lines),
        None,
        lines,
        file,
    )  # for debuggers and whatever reads a function's text
    exec(compile("".join(lines), file, "exec"), space)
    again: Callable[[Any], None] = compilable(space[name])
    return again


def _assignments(place: str, start: Any) -> Iterator[str]:
    for field in fields(start):
        name, value = f"{place}.{field.name}", getattr(start, field.name)
        if is_dataclass(value):
            yield from _assignments(name, value)
        elif isinstance(value, list):
            # All numbers of a series start alike.
            yield f"for n in range({len(value)}):"
            yield f"    {name}[n] = {value[0]!r}"
        else:
            yield f"{name} = {value!r}"


@dataclass(slots=True)
class Filtered:
    """A number behind a first-order filter, in its own unit."""

    value: float = entry(unit="its own", about="filtered number")
    known: bool = entry(
        False, unit="1", about="whether there has been a number; the first one passes"
    )


@compilable
def filter_share(period: float, time_constant: float) -> float:
    """Share of the gap that a first-order filter closes in one period, by implicit Euler [1]."""
    return period / (period + time_constant)


@compilable
def follow(s: Filtered, value: float, share: float) -> float:
    """The filtered number, a share of the gap nearer to this one."""
    if not s.known:
        s.known = True
        s.value = value
    else:
        s.value += share * (value - s.value)
    return s.value


forget_filtered = start_again(Filtered)  # the next number then passes as the first one


class WheelMotion(NamedTuple):
    """Measured motion of one wheel, counted positive in the direction of its request."""

    speed: float  # [rad/s]
    rolling: float  # speed at which it would roll [rad/s]
    acceleration: float  # mean over the last period, not filtered [rad/s^2]
    torque: float  # mean over the last period [N m]
    body_acceleration: float  # of the car [m/s^2]
    forward_acceleration: float  # of the car to its front, in reverse as well [m/s^2]
    lateral_acceleration: float  # of the car to its left [m/s^2]
    place: int  # of the wheel, in the order of Wheels
    ahead: float  # 1 if the request is to the front, -1 in reverse
    car_speed: float  # to its front [m/s]
    yaw_rate: float  # [rad/s]
    road_wheel_angle: float  # mean of the front wheels [rad]


def slowest_wheel() -> Any:
    """The parameter `slowest` of those that take a slip by `slip_of`."""
    return parameter(
        3.0,
        unit="rad/s",
        low=0.1,
        high=100.0,
        about="least wheel speed that slip is counted against: rest is no slip",
    )


def share_at_rest(share: float) -> Any:
    """The parameter `at_rest` of those that take a share of their slips by `share_at`."""
    return parameter(
        share,
        unit="1",
        low=0.01,
        high=1.0,
        about="share of the wanted slip that a limited wheel has at rest; from `slowest` on it is "
        "whole. With 1 a tread that slides by slip times `slowest` passes as one that grips, and "
        "the car stands on a slippery hill",
    )


@compilable
def share_at(motion: WheelMotion, slowest: float, at_rest: float) -> float:
    """Share [1] of a wanted slip at the speed of the car: `at_rest`, and all from `slowest` on."""
    return at_rest + (1.0 - at_rest) * min(abs(motion.rolling) / slowest, 1.0)


@compilable
def slip_of(motion: WheelMotion, slowest: float) -> float:
    """Slip 1 - w_free/w [1] (dissertation, eq 2.34), against at least `slowest`: rest is none."""
    return (motion.speed - motion.rolling) / max(abs(motion.speed), slowest)


@compilable
def road_torque(car: Car, motion: WheelMotion) -> float:
    """Torque that the road takes from a wheel, M - J w' [N m], mean over the last period."""
    return motion.torque - car.driven_wheel_inertia[motion.place] * motion.acceleration


@compilable
def mass_share(car: Car) -> float:
    """Mass that one driven wheel has to move [kg]; the source's M is that of a single wheel."""
    return car.mass / max(car.number_driven, 1.0)


@compilable
def wheel_load(
    car: Car, wheel: int, longitudinal_acceleration: float, lateral_acceleration: float
) -> float:
    """Load of a wheel [N] by the accelerations of the car to its front and left [m/s^2].

    F_z = m (g b/L -+ h a_x/L)/2 -+ k h m a_y/t, with the front (b: rear) arm of the centre of mass.
    Dissertation, eqs 2.28 to 2.31, for a centre of mass in the car's middle; k is the axle's share
    of the roll moment. Never below a tenth of the load at rest, where the car would be on three
    wheels.
    """
    half_mass = car.mass / 2.0
    # Half of m h a_x/L: both wheels of an axle share what moves from one axle to the other.
    along = half_mass * car.pitch_height / car.wheelbase * longitudinal_acceleration
    front = wheel in (FRONT_LEFT, FRONT_RIGHT)
    roll = car.front_roll_share if front else 1.0 - car.front_roll_share
    track = car.front_track if front else car.rear_track
    across = 2.0 * half_mass * car.roll_height * roll / track * lateral_acceleration
    at_rest = load_at_rest(car, wheel)
    load = at_rest - along if front else at_rest + along
    load = load - across if wheel in (FRONT_LEFT, REAR_LEFT) else load + across
    # No law may divide by the load of a lifted wheel.
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
