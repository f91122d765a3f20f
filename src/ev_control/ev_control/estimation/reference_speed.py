"""Speed that slip is counted against: what every wheel would turn at if it rolled.

How it works: each wheel means a speed of the car, by the bend that the car drives
(`rolling_speeds`). Wheels without a motor roll, so their mean is the speed. Where there are none,
or none is believed, an observer goes on with the accelerometer and is drawn to the wheels: fast
where a wheel cannot be slipping, slowly where it may (`observed_speed`). While the car stands, what
the accelerometer shows is its offset.
"""

from dataclasses import dataclass
from enum import auto
from math import inf
from operator import attrgetter
from typing import Any

from ev_control.estimation.plausible import (
    Sensors,
    SpeedEvidence,
    WheelTrustParameters,
    WheelTrustState,
    believed,
    judge_wheels,
)
from ev_core.law import (
    WHEEL_NAMES,
    Car,
    Choice,
    Need,
    Vehicle,
    Wheels,
    compilable,
    cos,
    entry,
    part,
    sin,
)
from ev_core.parameters.declaration import group, parameter

STANDING = 0.05  # tread of a wheel that stands, above the noise of wheel speeds [m/s]


class Source(Choice):
    """Sources of the speed of the car."""

    AUTOMATIC = auto()
    FREE_WHEELS = auto()
    OBSERVER = auto()


@compilable
def free_wheel_speed(
    car: Car, wheel_velocity: Wheels, road_wheel_angle: float, yaw_rate: float
) -> float:
    """Longitudinal velocity of the centre of mass [m/s] from front wheels that roll without slip.

    The middle of the front axle moves with R (w_1 + w_2)/2 = u cos(delta) + (v + a r) sin(delta)
    along the wheels, and the rear axle is taken to move straight ahead, v = b r, so u = (R (w_1 +
    w_2)/2 - L r sin(delta))/cos(delta). Wheel velocities [rad/s], angle left positive [rad], yaw
    rate [rad/s]. A slip angle d of the rear axle leaves the error u tan(delta) sin(d), 0.1 % at 2
    deg each. An assumption of this project, no source has it.
    """
    rolling = car.wheel_radius * (wheel_velocity.front_left + wheel_velocity.front_right) / 2.0
    turning = car.wheelbase * yaw_rate * sin(road_wheel_angle)
    return (rolling - turning) / cos(road_wheel_angle)


@dataclass(frozen=True, slots=True)
class StandstillParameters:
    """Offset of the accelerometer, learnt while the car stands; all of it is assumed.

    On a slope a car's shows g sin(angle) as well, which `largest` bounds; the plant's does not.
    """

    rate: float = parameter(
        0.0,
        unit="1/s",
        low=0.0,
        high=100.0,
        about="at which the observer learns the offset; 0: never, nor that it stands",
    )
    largest: float = parameter(
        0.3, unit="m/s^2", low=0.0, high=10.0, about="offset that is believed"
    )
    time: float = parameter(
        0.5,
        unit="s",
        low=0.0,
        high=100.0,
        about="for which all wheels stand until the car counts as standing",
    )
    speed: float = parameter(
        5.0,
        unit="m/s",
        low=0.0,
        high=100.0,
        about="estimated, above which wheels that stand are locked ones",
    )


@dataclass(frozen=True, slots=True)
class ReferenceSpeedParameters:
    """Source of the speed of the car, and trust in wheels and accelerometer."""

    source: Source = parameter(
        Source.AUTOMATIC,
        about="free_wheels: wheels without a motor; observer: acceleration, corrected by the "
        "wheels; automatic: free wheels where the car has any",
        source="dissertation, eq 2.34, has free wheels; the observer is an assumption",
    )
    gripping_rate: float = parameter(
        20.0,
        unit="1/s",
        low=0.0,
        high=1000.0,
        about="correction of the observer by a wheel that cannot be slipping",
    )
    slipping_rate: float = parameter(
        0.5,
        unit="1/s",
        low=0.0,
        high=1000.0,
        about="correction by wheels that may slip; bounds what offsets add up to",
    )
    standstill: StandstillParameters = group(StandstillParameters)
    trust: WheelTrustParameters = group(WheelTrustParameters)


@dataclass(slots=True)
class ReferenceSpeedState:
    """State of the speed estimate."""

    speed: float = entry(
        unit="m/s", about="estimated speed of the car along its axis, negative in reverse"
    )
    offset: float = entry(unit="m/s^2", about="of the accelerometer, as far as it is known")
    stood: float = entry(unit="s", about="since when all wheels stand")
    trust: WheelTrustState = part(WheelTrustState)


def free_wheels_for(group: str) -> Need:
    """Need of a wheel without a motor, where the parameters of a group ask for free wheels."""

    def lacks(parameters: Any, vehicle: Vehicle) -> str:
        if attrgetter(group)(parameters).source != Source.FREE_WHEELS or set(WHEEL_NAMES) - set(
            vehicle.driven_wheels
        ):
            return ""
        return f"a wheel without a motor for {group}.source free_wheels"

    return lacks


@compilable
def rolling_speeds(
    p: ReferenceSpeedParameters,
    car: Car,
    s: ReferenceSpeedState,
    period: float,
    sensors: Sensors,
    direction: float,
) -> Wheels:
    """Speeds [rad/s] at which the wheels would roll in the bend that the car drives.

    The middle of the rear axle is taken to move straight ahead. Left wheels then move at u - r t/2
    and right ones at u + r t/2 along the car (track t, yaw rate r), and steered ones at (u -+ r
    t/2) cos(delta) + L r sin(delta) along themselves. `free_wheels` turns this round and takes the
    mean of the wheels without a motor, which roll as long as the driver does not brake; `observer`
    see `observed_speed`, which also takes over where no wheel without a motor is believed any more
    (`trust.watch`). The first speed is the mean of all wheels, since a car may begin, or its
    controller be restarted, on the move. `direction` is the sign of what the drives are asked for.
    """
    velocity = sensors.wheels.velocity
    imu = sensors.imu
    angle = sensors.column.road_wheel_angle
    r, radius = imu.yaw_rate, car.wheel_radius
    cosine, across = cos(angle), car.wheelbase * r * sin(angle)
    front, rear = r * (car.front_track / 2.0), r * (car.rear_track / 2.0)
    # Each wheel speed brought to the middle of the rear axle; the returned speeds go the other way.
    by_wheel = Wheels(
        (velocity.front_left * radius - across) / cosine + front,
        (velocity.front_right * radius - across) / cosine - front,
        velocity.rear_left * radius + rear,
        velocity.rear_right * radius - rear,
    )
    # What the accelerometer shows of the change of speed.
    gained = (imu.longitudinal_acceleration - s.offset) * period
    if not s.trust.known:
        s.trust.known = True
        s.speed = ((by_wheel[0] + by_wheel[1]) + (by_wheel[2] + by_wheel[3])) / 4.0
    elif p.trust.watch:
        seen = SpeedEvidence(velocity, by_wheel, s.speed + gained, gained, direction)
        judge_wheels(p.trust, car, s.trust, period, seen)
    number, total = free_wheels(car, s, by_wheel)
    # Also with free wheels, where none of them is believed.
    if p.source == Source.OBSERVER or number == 0.0:
        if p.standstill.rate > 0.0 and stands(p.standstill, car, s, period, velocity):
            learn_offset(p.standstill, s, period, imu.longitudinal_acceleration)
            s.speed = 0.0
        else:
            s.speed = observed_speed(p, s, period, by_wheel, gained, direction)
    else:
        s.speed = total / number
    u = s.speed
    return Wheels(
        ((u - front) * cosine + across) / radius,
        ((u + front) * cosine + across) / radius,
        (u - rear) / radius,
        (u + rear) / radius,
    )


@compilable
def free_wheels(car: Car, s: ReferenceSpeedState, by_wheel: Wheels) -> tuple[float, float]:
    """Number of believed wheels without a motor [1], and the sum of the speeds they mean [m/s]."""
    left_out = s.trust.left_out
    a = (1.0 - car.driven[0]) * (1.0 - left_out[0])
    b = (1.0 - car.driven[1]) * (1.0 - left_out[1])
    c = (1.0 - car.driven[2]) * (1.0 - left_out[2])
    d = (1.0 - car.driven[3]) * (1.0 - left_out[3])
    front = a * by_wheel[0] + b * by_wheel[1]
    rear = c * by_wheel[2] + d * by_wheel[3]
    return (a + b) + (c + d), front + rear


@compilable
def observed_speed(
    p: ReferenceSpeedParameters,
    s: ReferenceSpeedState,
    period: float,
    by_wheel: Wheels,
    gained: float,
    ahead: float,
) -> float:
    """Speed of the car [m/s] by what it has gained, corrected by what rolling wheels would mean.

    A wheel that is driven never turns slower than it would roll, a braked one never faster: so the
    slowest wheel (braking: the fastest) limits the estimate quickly (`gripping_rate`) and otherwise
    only draws it slowly (`slipping_rate`), because all wheels may be slipping. Where no wheel is
    believed the acceleration is all there is.
    """
    u = s.speed + gained
    if believed(s.trust) == 0.0:
        return u
    slowest, fastest = inf, -inf
    for i in range(4):
        if not s.trust.left_out[i]:
            slowest = min(slowest, by_wheel[i])
            fastest = max(fastest, by_wheel[i])
    if ahead == 0.0:
        gap = (slowest + fastest) / 2.0 - u  # wheels without torque roll
        return u + gap * min(p.gripping_rate * period, 1.0)
    # The wheel that cannot be slipping: the slowest of driven ones, the fastest of braked ones.
    gap = (slowest if ahead > 0.0 else fastest) - u
    # Beyond that wheel the estimate is wrong for sure; on its other side it need not be.
    rate = p.gripping_rate if gap * ahead < 0.0 else p.slipping_rate
    # More than the whole gap in a period would overshoot.
    return u + gap * min(rate * period, 1.0)


@compilable
def stands(
    p: StandstillParameters, car: Car, s: ReferenceSpeedState, period: float, velocity: Wheels
) -> bool:
    """Return true if all wheels have stood for some time, and the car was not fast before."""
    front = max(abs(velocity[0]), abs(velocity[1]))
    rear = max(abs(velocity[2]), abs(velocity[3]))
    fastest = max(front, rear)
    s.stood = s.stood + period if fastest * car.wheel_radius < STANDING else 0.0
    return s.stood > p.time and abs(s.speed) <= p.speed


@compilable
def learn_offset(
    p: StandstillParameters, s: ReferenceSpeedState, period: float, acceleration: float
) -> None:
    """Take what the accelerometer shows at rest [m/s^2] for its offset, first order."""
    learned = s.offset + min(p.rate * period, 1.0) * (acceleration - s.offset)
    s.offset = min(max(learned, -p.largest), p.largest)
