"""A steering robot: the steering-wheel angle of standard manoeuvres, whatever the road wheels do against it."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ev_core.elementary import sin
from ev_core.law import Car, Instant, SteeringColumnState, Vehicle, compilable, entry, group, method, parameter, setting
from ev_sim.profiles.profile import Profile, check_points, interpolation_parameter, profile_of, value_at

ROBOT_SHAPES = ("profile", "sine_with_dwell")
PROFILE, SINE_WITH_DWELL = range(len(ROBOT_SHAPES))


@dataclass(frozen=True, slots=True)
class SteeringAngleProfileParameters:
    """Steering-wheel angle over time, left positive."""

    time: tuple[float, ...] = setting((0.0,), unit="s", about="times of the points, increasing")
    angle: tuple[float, ...] = setting(
        (0.0,), unit="rad", low=-30.0, high=30.0, about="angles at these times; the last holds", lateral=True
    )
    interpolation: str = interpolation_parameter("linear")

    def __post_init__(self) -> None:
        check_points("time", self.time, "angle", self.angle)


@dataclass(frozen=True, slots=True)
class SineWithDwellParameters:
    """One period of a sine that stays at its second peak for a while."""

    begin: float = setting(1.0, unit="s", low=0.0, high=1e5, about="when the sine begins")
    amplitude: float = setting(
        1.0, unit="rad", low=-30.0, high=30.0, about="of the steering wheel, first to the left", lateral=True
    )
    frequency: float = parameter(0.7, unit="Hz", low=0.01, high=10.0, about="of the sine", source="UN R140, FMVSS 126")
    dwell: float = parameter(
        0.5, unit="s", low=0.0, high=10.0, about="stay at the second peak", source="UN R140, FMVSS 126"
    )


@dataclass(frozen=True, slots=True)
class SteeringRobotParameters:
    """Which angle the robot imposes, and how fast it can turn."""

    shape: str = setting("profile", choices=ROBOT_SHAPES, about="what the robot steers")
    scale: float = setting(
        1.0, unit="1", low=0.0, high=100.0, about="of the angles of profile and sine: another car takes other ones"
    )
    profile: SteeringAngleProfileParameters = group(SteeringAngleProfileParameters)
    sine_with_dwell: SineWithDwellParameters = group(SineWithDwellParameters)
    max_rate: float = parameter(25.0, unit="rad/s", low=0.01, high=100.0, about="fastest turning of the steering wheel")


@dataclass(slots=True)
class SteeringRobotState:
    """Where the robot holds the steering wheel; left positive."""

    angle: float = entry(unit="rad", about="now")
    next_angle: float = entry(unit="rad", about="a period later")


def profile(parameters: SteeringRobotParameters, _vehicle: Vehicle, _period: float) -> Profile:
    """The profile of the angle over time, whether it is the chosen shape or not."""
    p = parameters.profile
    return profile_of(p.time, tuple(parameters.scale * angle for angle in p.angle), p.interpolation)


def at_its_beginning(p: SteeringRobotParameters, c: Profile, period: float) -> SteeringRobotState:
    """The robot holds the angle that is wanted at first."""
    begin = wanted_angle(p, c, 0.0)
    return SteeringRobotState(begin, turned(p, period, begin, wanted_angle(p, c, period)))


@compilable
def shown(car: Car, s: SteeringRobotState, period: float) -> SteeringColumnState:
    """The column at this instant."""
    rate = (s.next_angle - s.angle) / period
    return SteeringColumnState(s.angle, rate, 0.0, s.angle / car.steering_ratio, rate / car.steering_ratio)


@method(
    "steering_column",
    "steering_robot",
    SteeringRobotParameters,
    state=SteeringRobotState,
    prepare=profile,
    start=at_its_beginning,
    outputs=shown,
    mirrored=True,
)
@compilable
def steering_robot(p: SteeringRobotParameters, c: Profile, s: SteeringRobotState, period: float, now: Instant) -> None:
    """Impose a steering-wheel angle over time, as fast as the robot can turn; the road wheels follow rigidly.

    The rate is the mean one over the coming period, so that an angle that goes on at its rate until the next instant
    has no jumps. The robot needs no hands and reports no hand torque.
    """
    s.angle = s.next_angle
    s.next_angle = turned(p, period, s.angle, wanted_angle(p, c, now.time + 2 * period))


@compilable
def wanted_angle(p: SteeringRobotParameters, points: Profile, t: float) -> float:
    """Steering-wheel angle [rad] that is wanted at the time t [s]."""
    if p.shape == SINE_WITH_DWELL:
        return sine_with_dwell(p.sine_with_dwell, p.scale * p.sine_with_dwell.amplitude, t)
    return value_at(points, t)


@compilable
def sine_with_dwell(p: SineWithDwellParameters, amplitude: float, t: float) -> float:
    """A sin(2 pi f t), held for the dwell at its second peak, at three quarters of the period (UN R140, FMVSS 126)."""
    since, second_peak = t - p.begin, 0.75 / p.frequency
    since -= min(max(since - second_peak, 0.0), p.dwell)
    if not 0.0 < since < 1 / p.frequency:
        return 0.0
    return amplitude * sin(math.tau * p.frequency * since)


@compilable
def turned(p: SteeringRobotParameters, period: float, angle: float, wanted: float) -> float:
    """The angle after a period in which the robot turns towards the wanted one as fast as it can [rad]."""
    most = p.max_rate * period
    return angle + min(max(wanted - angle, -most), most)
