"""Wheel that drive and friction brake slow down together: what its slip allows, and which gives it.

Besides, the yaw rate that the steering asks for, and what drives left and right do for it.
"""

from dataclasses import dataclass
from enum import auto
from math import inf
from typing import NamedTuple

from ev_control.estimation.wheel_dynamics import (
    Filtered,
    filter_share,
    follow,
    forget_filtered,
    slowest_wheel,
)
from ev_control.shared.allocation import motor_range
from ev_core.law import (
    Car,
    Choice,
    InertialMeasurement,
    compilable,
    copysign,
    cos,
    entry,
    parameter,
    part,
    sin,
    turning_length,
)


class Blending(Choice):
    """The one of drive and friction brake that keeps the slip of a braked wheel."""

    DRIVES = auto()
    FRICTION = auto()


@dataclass(frozen=True, slots=True)
class SlipLimitParameters:
    """Slip that is kept, and how fast; all assumptions."""

    target: float = parameter(
        0.1,
        unit="1",
        low=0.01,
        high=0.5,
        about="largest slip; the peaks of snow and wet asphalt lie at 0.09 and 0.13",
    )
    rate: float = parameter(
        25.0, unit="1/s", low=1.0, high=1000.0, about="decay of what the speed is beyond the slip"
    )
    filter_time: float = parameter(
        0.02, unit="s", low=0.0, high=1.0, about="time constant of the torque of the road"
    )
    release: float = parameter(
        0.1,
        unit="s",
        low=0.0,
        high=100.0,
        about="time for which the limit has to be above what is wanted to end",
    )
    slowest: float = slowest_wheel()


@dataclass(slots=True)
class SlipLimitedWheel:
    """State of a wheel with a limited slip."""

    limit: float = entry(inf, unit="N m", about="largest torque, in the direction that is limited")
    side: float = entry(
        unit="1", about="direction that is watched along the travel: 1 drives, -1 brakes"
    )
    served: float = entry(unit="s", about="since when the limit is above what is wanted")
    road: Filtered = part(Filtered)  # torque of the road, driving positive [N m]


@dataclass(frozen=True, slots=True)
class BlendingParameters:
    """Shares of drive and friction brake, and the speed of a friction brake; all assumptions."""

    blending: Blending = parameter(
        Blending.DRIVES,
        about="drives: they brake as far as they can, and fast; friction: they only do what is "
        "asked of them, and the friction brakes alone keep the slip, as in a car with an ABS of "
        "its brakes",
    )
    use: float = parameter(
        0.8,
        unit="1",
        low=0.0,
        high=1.0,
        about="share of what a drive can brake that it does on the mean while its wheel is "
        "limited; the rest is to brake more at once",
    )
    lag: float = parameter(
        0.05, unit="s", low=0.0, high=1.0, about="time constant of a friction brake"
    )
    slew: float = parameter(
        15e3, unit="N m/s", low=100.0, high=1e7, about="fastest change of a friction brake"
    )


@dataclass(slots=True)
class BlendedWheel:
    """State of a wheel with drive and friction brake."""

    slip: SlipLimitedWheel = part(SlipLimitedWheel)
    friction: float = entry(unit="N m", about="torque of its friction brake")


class WheelAlong(NamedTuple):
    """Measured motion of a wheel, positive along the travel of the car."""

    speed: float  # [rad/s]
    rolling: float  # speed at which it would roll [rad/s]
    acceleration: float  # mean over the last period [rad/s^2]
    rolling_acceleration: float  # [rad/s^2]
    torque: float  # of drive and brake, mean over the last period [N m]
    inertia: float  # of the wheel and its drive [kg m^2]


@compilable
def forget_slip_limit(w: SlipLimitedWheel) -> None:
    """Put a wheel back to the start."""
    w.limit = inf
    w.side = 0.0
    w.served = 0.0
    forget_filtered(w.road)


@compilable
def slip_limited(
    p: SlipLimitParameters,
    w: SlipLimitedWheel,
    period: float,
    motion: WheelAlong,
    wanted: float,
    share: float,
) -> float:
    """Wanted torque [N m], along the travel, or the one that holds a share [1] of the target slip.

    |M| <= |M_road + J (w_free' + k (w* - w))| with w* = (1 - S*) w_free braking and w_free/(1 - S*)
    driving, so that w - w* decays with k; M_road = M - J w' is filtered. A wheel is limited from
    the first slip beyond S* until the limit has been above what is wanted for `release`. Slip
    counts against at least `slowest`. An assumption; with the torque of the road in it the limit
    rises and falls with the friction, as in `least_squares`.
    """
    side = 0.0 if wanted == 0.0 else copysign(1.0, wanted)
    # Driving and braking have limits of their own: a change of side starts again.
    if side != w.side:
        forget_slip_limit(w)
        w.side = side
    if side == 0.0:
        return wanted
    inertia = motion.inertia
    torque = motion.torque - inertia * motion.acceleration
    road = follow(w.road, torque, filter_share(period, p.filter_time))
    slip = share * p.target
    # The speed difference that belongs to the slip; driving, slip counts against the faster wheel.
    room = slip * max(motion.rolling, p.slowest) / (1.0 if side < 0.0 else 1.0 - slip)
    excess = side * (motion.speed - motion.rolling) - room
    if w.limit == inf and excess <= 0.0:
        return wanted
    # Hold the road torque, follow the rolling speed, and take the excess away with `rate`.
    limit = side * road + inertia * (side * motion.rolling_acceleration - p.rate * excess)
    w.served = w.served + period if limit >= abs(wanted) else 0.0
    w.limit = inf if w.served > p.release else max(limit, 0.0)
    return side * min(w.limit, abs(wanted))


class DriveRange(NamedTuple):
    """Torques of a drive along the travel of the car, both positive [N m]."""

    brakes: float
    pushes: float


class WheelDemand(NamedTuple):
    """Torques that are asked of a wheel along the travel of the car [N m]."""

    net: float  # of drive and brake together
    drive: float
    pedal: float  # of the brake pedal, never negative


@compilable
def drive_range(car: Car, place: int, velocity: float, ahead: float) -> DriveRange:
    """Torques that a drive can give at a wheel speed [rad/s], as far as the battery takes them."""
    can = motor_range(car, place, velocity)
    # In reverse the torque that brakes is the positive one.
    brakes, pushes = (-can.least, can.most) if ahead > 0.0 else (can.most, -can.least)
    turns = abs(velocity)
    # An equal share of what the battery takes, whatever the other wheels do.
    charged = car.battery.charge_power / max(car.number_driven * turns, 1.0)
    # Towards rest the drive hands its braking over to the friction brake.
    return DriveRange(min(brakes, charged) * min(turns / car.blend_fade_speed, 1.0), pushes)


@compilable
def blended(
    p: BlendingParameters, w: BlendedWheel, period: float, can: DriveRange, asked: WheelDemand
) -> float:
    """Torque of the drive along the travel [N m]; the friction brake goes on in the state."""
    brakes, pushes = can.brakes, can.pushes
    # The drive does what is asked of it and no more; the friction brake alone follows the slip.
    if p.blending == Blending.FRICTION:
        brakes = min(max(-asked.drive, 0.0), brakes)
        pushes = max(min(asked.net, pushes), 0.0)
    # A drive that keeps the slip needs room to both sides, so it does not brake with all it has.
    all_of_it = w.slip.limit == inf or p.blending == Blending.FRICTION
    used = brakes if all_of_it else p.use * brakes
    # What the drive does not brake is for the friction brake, never more than the pedal asks.
    gap = min(max(-asked.net - used, 0.0), asked.pedal) - w.friction
    step = gap * filter_share(period, p.lag)
    most = p.slew * period
    w.friction = min(max(w.friction + min(max(step, -most), most), 0.0), asked.pedal)
    return min(max(asked.net + w.friction, -brakes), pushes)


@dataclass(frozen=True, slots=True)
class YawDifferenceParameters:
    """Wanted yaw rate, and how firmly it is followed; all assumptions."""

    gain: float = parameter(
        10.0,
        unit="1/s",
        low=0.0,
        high=200.0,
        about="wanted yaw acceleration over the error of the yaw rate; 0: none",
    )
    yielding: float = parameter(
        0.2,
        unit="rad/s",
        low=0.01,
        high=10.0,
        about="error at which a wheel that turns the car the wrong way is allowed no slip",
    )
    deadband: float = parameter(
        0.02, unit="rad/s", low=0.0, high=1.0, about="error that is left alone"
    )
    understeer: float = parameter(
        0.002,
        unit="rad s^2/m",
        low=0.0,
        high=0.1,
        about="road-wheel angle that the car needs more per m/s^2 across",
    )
    margin: float = parameter(
        1.0,
        unit="m/s^2",
        low=0.0,
        high=20.0,
        about="by which the yaw rate may ask for more than is measured across",
    )


@compilable
def yaw_error(
    p: YawDifferenceParameters,
    car: Car,
    speed: float,
    road_wheel_angle: float,
    imu: InertialMeasurement,
) -> float:
    """Wanted minus measured yaw rate [rad/s], beyond the deadband.

    r* = V tan(delta)/(L + K V |V|), the steady single-track model with K the understeer gradient,
    within what the road gives now, (|a_y| + margin)/|V|: no friction has to be known. V along the
    car's axis, negative in reverse [m/s].
    """
    length = turning_length(car.wheelbase, p.understeer, speed)
    steered = speed * sin(road_wheel_angle) / cos(road_wheel_angle) / length
    # More yaw rate than the lateral acceleration carries would turn the car into a skid.
    most = (abs(imu.lateral_acceleration) + p.margin) / max(abs(speed), 0.1)
    error = min(max(steered, -most), most) - imu.yaw_rate
    return copysign(max(abs(error) - p.deadband, 0.0), error)


@compilable
def yaw_difference(p: YawDifferenceParameters, car: Car, error: float) -> float:
    """Torque [N m] that each right wheel gets more and each left one less.

    M_z = J_z k (r* - r) by the driven axles.
    """
    track = (car.front_track + car.rear_track) / 2.0
    axles = max(car.number_driven / 2.0, 1.0)
    return car.yaw_inertia * p.gain * error * car.wheel_radius / (track * axles)


@compilable
def slip_share(p: YawDifferenceParameters, error: float, turning: float) -> float:
    """Share of its slip [1] that a wheel keeps.

    `turning` is above zero where its torque turns the car to the left.
    """
    return 1.0 if turning * error >= 0.0 else max(1.0 - abs(error) / p.yielding, 0.0)
