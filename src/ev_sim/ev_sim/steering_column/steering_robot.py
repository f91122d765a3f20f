"""A steering robot: the steering-wheel angle of standard manoeuvres, whatever the road wheels do against it."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ev_msgs_py.methods import method
from ev_msgs_py.parameters import group, parameter
from ev_msgs_py.signals import Instant, SteeringColumnState
from ev_msgs_py.vehicle import Vehicle
from ev_sim.driver.profile import Profile, check_points, interpolation_parameter


@dataclass(frozen=True, slots=True)
class SteeringAngleProfileParameters:
    """Steering-wheel angle over time, left positive."""

    time: tuple[float, ...] = parameter((0.0,), unit="s", about="times of the points, increasing")
    angle: tuple[float, ...] = parameter(
        (0.0,), unit="rad", low=-30.0, high=30.0, about="steering-wheel angles at these times; the last one holds"
    )
    interpolation: str = interpolation_parameter("linear")

    def __post_init__(self) -> None:
        check_points("time", self.time, "angle", self.angle)


@dataclass(frozen=True, slots=True)
class SineWithDwellParameters:
    """One period of a sine that stays at its second peak for a while."""

    begin: float = parameter(1.0, unit="s", low=0.0, high=1e5, about="when the sine begins")
    amplitude: float = parameter(
        1.0,
        unit="rad",
        low=-30.0,
        high=30.0,
        about="of the steering wheel, first to the left",
    )
    frequency: float = parameter(0.7, unit="Hz", low=0.01, high=10.0, about="of the sine", source="UN R140, FMVSS 126")
    dwell: float = parameter(
        0.5, unit="s", low=0.0, high=10.0, about="stay at the second peak", source="UN R140, FMVSS 126"
    )


@dataclass(frozen=True, slots=True)
class SteeringRobotParameters:
    """Which angle the robot imposes, and how fast it can turn."""

    shape: str = parameter("profile", choices=("profile", "sine_with_dwell"), about="what the robot steers")
    profile: SteeringAngleProfileParameters = group(SteeringAngleProfileParameters)
    sine_with_dwell: SineWithDwellParameters = group(SineWithDwellParameters)
    max_rate: float = parameter(
        25.0, unit="rad/s", low=0.01, high=100.0, about="fastest turning of the steering wheel", source="assumption"
    )


class SineWithDwell:
    """A sin(2 pi f t), held for the dwell at its second peak, at three quarters of the period (UN R140, FMVSS 126)."""

    def __init__(self, parameters: SineWithDwellParameters) -> None:
        self._p = parameters

    def at(self, t: float) -> float:
        """Steering-wheel angle [rad] at the time t [s]."""
        p = self._p
        since, second_peak = t - p.begin, 0.75 / p.frequency
        since -= min(max(since - second_peak, 0.0), p.dwell)
        if not 0.0 < since < 1 / p.frequency:
            return 0.0
        return p.amplitude * math.sin(math.tau * p.frequency * since)


@dataclass(slots=True)
class SteeringRobotState:
    """Steering-wheel angle now and a period later [rad]."""

    angle: float
    next_angle: float


@method("steering_column", "steering_robot")
class SteeringRobot:
    """Impose a steering-wheel angle over time, as fast as the robot can turn; the road wheels follow rigidly.

    The rate is the mean one over the coming period, so that an angle that goes on at its rate until the next instant
    has no jumps. The robot needs no hands and reports no hand torque.
    """

    parameters = SteeringRobotParameters

    def __init__(self, parameters: SteeringRobotParameters, vehicle: Vehicle, period: float) -> None:
        p = parameters
        shape = Profile(p.profile.time, p.profile.angle, p.profile.interpolation)
        self._wanted = SineWithDwell(p.sine_with_dwell) if p.shape == "sine_with_dwell" else shape
        self._ratio, self._period, self._max_change = vehicle.steering_ratio, period, p.max_rate * period
        begin = self._wanted.at(0.0)
        self.state = SteeringRobotState(begin, self._towards(self._wanted.at(period), begin))

    def outputs(self) -> tuple[SteeringColumnState]:
        """The column at this instant."""
        s, i = self.state, self._ratio
        rate = (s.next_angle - s.angle) / self._period
        return (SteeringColumnState(s.angle, rate, 0.0, s.angle / i, rate / i),)

    def advance(self, now: Instant) -> None:
        """Go on by one period from this instant."""
        s = self.state
        s.angle = s.next_angle
        s.next_angle = self._towards(self._wanted.at(now.time + 2 * self._period), s.angle)

    def _towards(self, wanted: float, angle: float) -> float:
        return angle + min(max(wanted - angle, -self._max_change), self._max_change)
