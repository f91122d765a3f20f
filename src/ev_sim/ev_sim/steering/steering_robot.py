"""A steering robot for standard manoeuvres, with or without active front steering.

How it works: the angle over time is given. The robot keeps the angle of now and that of a period
later, so that the column shows the rate that leads from one to the other; a plant goes on at that
rate between two instants. `active_front` adds an angle to the road wheels, behind the steering
wheel.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial
from typing import NamedTuple

from ev_core.law import (
    Car,
    Vehicle,
    compilable,
    entry,
    group,
    method,
    parameter,
    setting,
    sin,
    tan,
    turning_length,
)
from ev_msgs_py.contract.signals import BodyVelocity, Instant, SteeringColumnState
from ev_sim.profiles.profile import (
    Profile,
    check_points,
    interpolation_parameter,
    profile_of,
    value_at,
)

ROBOT_SHAPES = ("profile", "sine_with_dwell")
PROFILE, SINE_WITH_DWELL = range(len(ROBOT_SHAPES))


@dataclass(frozen=True, slots=True)
class SteeringAngleProfileParameters:
    """Steering-wheel angle over time, left positive."""

    time: tuple[float, ...] = setting((0.0,), unit="s", about="times of the points, increasing")
    angle: tuple[float, ...] = setting(
        (0.0,),
        unit="rad",
        low=-30.0,
        high=30.0,
        about="angles at these times; the last holds",
        lateral=True,
    )
    interpolation: str = interpolation_parameter("linear")

    def __post_init__(self) -> None:
        check_points("time", self.time, "angle", self.angle)


@dataclass(frozen=True, slots=True)
class SineWithDwellParameters:
    """One period of a sine that stays at its second peak for a while."""

    begin: float = setting(1.0, unit="s", low=0.0, high=1e5, about="when the sine begins")
    amplitude: float = setting(
        1.0,
        unit="rad",
        low=-30.0,
        high=30.0,
        about="of the steering wheel, first to the left",
        lateral=True,
    )
    frequency: float = parameter(
        0.7, unit="Hz", low=0.01, high=10.0, about="of the sine", source="UN R140, FMVSS 126"
    )
    dwell: float = parameter(
        0.5,
        unit="s",
        low=0.0,
        high=10.0,
        about="stay at the second peak",
        source="UN R140, FMVSS 126",
    )


@dataclass(frozen=True, slots=True)
class SteeringRobotParameters:
    """Angle that the robot imposes, and how fast it can turn."""

    shape: str = setting("profile", choices=ROBOT_SHAPES, about="what the robot steers")
    scale: float = setting(
        1.0,
        unit="1",
        low=0.0,
        high=100.0,
        about="of the angles of profile and sine: another car takes other ones",
    )
    profile: SteeringAngleProfileParameters = group(SteeringAngleProfileParameters)
    sine_with_dwell: SineWithDwellParameters = group(SineWithDwellParameters)
    max_rate: float = parameter(
        25.0, unit="rad/s", low=0.01, high=100.0, about="fastest turning of the steering wheel"
    )


@dataclass(slots=True)
class SteeringRobotState:
    """Angles at which the robot holds the steering wheel; left positive."""

    angle: float = entry(unit="rad", about="now")
    next_angle: float = entry(unit="rad", about="a period later")


def profile(parameters: SteeringRobotParameters, _vehicle: Vehicle, _period: float) -> Profile:
    """The profile of the angle over time, whether it is the chosen shape or not."""
    p = parameters.profile
    return profile_of(p.time, tuple(parameters.scale * angle for angle in p.angle), p.interpolation)


def at_its_beginning(
    p: SteeringRobotParameters,
    c: Profile,
    period: float,
    kind: type[SteeringRobotState] = SteeringRobotState,
) -> SteeringRobotState:
    """The robot holds the angle that is wanted at first; nothing is added."""
    begin = wanted_angle(p, c, 0.0)
    return kind(begin, towards(p, period, begin, wanted_angle(p, c, period)))


@compilable
def robot_column(car: Car, s: SteeringRobotState, period: float) -> SteeringColumnState:
    """The column at this instant."""
    rate = (s.next_angle - s.angle) / period
    return SteeringColumnState(
        s.angle, rate, 0.0, s.angle / car.steering_ratio, rate / car.steering_ratio
    )


robot_method = partial(method, "steering_column", prepare=profile, mirrored=True)


@robot_method("steering_robot", start=at_its_beginning, outputs=robot_column)
@compilable
def steering_robot(
    p: SteeringRobotParameters, c: Profile, s: SteeringRobotState, period: float, now: Instant
) -> None:
    """Impose a steering-wheel angle over time, as fast as the robot can turn.

    The road wheels follow rigidly. The rate is the mean one over the coming period, so that an
    angle that goes on at its rate until the next instant has no jumps. The robot needs no hands and
    reports no hand torque.
    """
    s.angle = s.next_angle
    # The column answers for the instant one period later: `angle` is that of then, `next_angle`
    # that of one period after it.
    s.next_angle = towards(p, period, s.angle, wanted_angle(p, c, now.time + 2 * period))


@compilable
def wanted_angle(p: SteeringRobotParameters, points: Profile, t: float) -> float:
    """Steering-wheel angle [rad] that is wanted at the time t [s]."""
    if p.shape == SINE_WITH_DWELL:
        return sine_with_dwell(p.sine_with_dwell, p.scale * p.sine_with_dwell.amplitude, t)
    return value_at(points, t)


@compilable
def sine_with_dwell(p: SineWithDwellParameters, amplitude: float, t: float) -> float:
    """A sin(2 pi f t), held for the dwell at its second peak (UN R140, FMVSS 126).

    The peak is at three quarters of the period.
    """
    since, second_peak = t - p.begin, 0.75 / p.frequency
    # The clock of the sine stands still at the peak for as long as the dwell lasts.
    since -= min(max(since - second_peak, 0.0), p.dwell)
    if not 0.0 < since < 1 / p.frequency:
        return 0.0
    return amplitude * sin(math.tau * p.frequency * since)


@compilable
def towards(p: SteeringRobotParameters, period: float, angle: float, wanted: float) -> float:
    """Angle after a period of turning as fast as the robot can towards the wanted one [rad]."""
    most = p.max_rate * period
    return angle + min(max(wanted - angle, -most), most)


@dataclass(frozen=True, slots=True)
class ActiveFrontParameters(SteeringRobotParameters):
    """Angle of the robot, wanted yaw rate, and limits of the superposing motor; all assumptions."""

    gain: float = parameter(
        1.0,
        unit="s",
        low=0.0,
        high=10.0,
        about="added road-wheel angle over the error of the yaw rate",
    )
    understeer: float = parameter(
        0.0,
        unit="rad s^2/m",
        low=0.0,
        high=0.1,
        about="road-wheel angle that the car needs more per m/s^2 across",
    )
    largest_acceleration: float = parameter(
        3.0,
        unit="m/s^2",
        low=0.1,
        high=20.0,
        about="across, that the wanted yaw rate keeps to: what the road gives",
    )
    largest_angle: float = parameter(
        0.15, unit="rad", low=0.0, high=0.7, about="that is added to the road wheels, either way"
    )
    largest_rate: float = parameter(
        0.5,
        unit="rad/s",
        low=0.01,
        high=10.0,
        about="at which the added angle changes, of a superposition gear",
    )
    slowest: float = parameter(
        1.0,
        unit="m/s",
        low=0.1,
        high=20.0,
        about="speed below which the added angle goes back to zero",
    )


@dataclass(slots=True)
class ActiveFrontState(SteeringRobotState):
    """The same, and the added angles."""

    added: float = entry(unit="rad", about="to the road wheels, now")
    next_added: float = entry(unit="rad", about="to the road wheels, a period later")


@compilable
def active_column(car: Car, s: ActiveFrontState, period: float) -> SteeringColumnState:
    """The column at this instant: the road-wheel angle is more than that of the steering wheel."""
    rate, added_rate = (s.next_angle - s.angle) / period, (s.next_added - s.added) / period
    ratio = car.steering_ratio
    return SteeringColumnState(
        s.angle, rate, 0.0, s.angle / ratio + s.added, rate / ratio + added_rate
    )


class Moving(NamedTuple):
    """Signals that active front steering reads: the time, and the motion of the car."""

    now: Instant
    body: BodyVelocity


@robot_method(
    "active_front",
    start=partial(at_its_beginning, kind=ActiveFrontState),
    outputs=active_column,
)
@compilable
def active_front(
    p: ActiveFrontParameters,
    car: Car,
    c: Profile,
    s: ActiveFrontState,
    period: float,
    read: Moving,
) -> None:
    """Steer as the robot does, and add k (r* - r) to the road wheels, by a superposition gear.

    r* = V tan(d)/(L + K V |V|) with the hands' own angle d, within a_y/|V|: the steady single-track
    model, no source has it. In reverse the sign turns around, since there the front wheels turn the
    car the other way. The added angle keeps to `largest_angle` and `largest_rate`; the hands do not
    feel it. The yaw rate and V are the true ones, as those of the rear steering are.
    """
    s.angle, s.added = s.next_angle, s.next_added
    s.next_angle = towards(p, period, s.angle, wanted_angle(p, c, read.now.time + 2 * period))
    speed, added = read.body.longitudinal, 0.0
    if abs(speed) >= p.slowest:
        # L + K V |V|, which turning_length keeps from zero.
        length = turning_length(car.wheelbase, p.understeer, speed)
        steered = speed * tan(s.angle / car.steering_ratio) / length
        # A road that gives a_y allows a yaw rate of a_y/V.
        most = p.largest_acceleration / abs(speed)
        error = min(max(steered, -most), most) - read.body.yaw_rate
        # In reverse a wheel that is turned to the left turns the car to the right.
        added = min(
            max(p.gain * (error if speed > 0.0 else -error), -p.largest_angle), p.largest_angle
        )
    # The gear is as slow on the way back to zero.
    step = p.largest_rate * period
    s.next_added = s.added + min(max(added - s.added, -step), step)
