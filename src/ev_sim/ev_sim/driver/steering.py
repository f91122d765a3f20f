"""The driver's hands: a given hand torque, or the torque that turns the road wheels to a wanted angle."""

from __future__ import annotations

from dataclasses import dataclass

from ev_msgs_py.parameters import group, parameter
from ev_msgs_py.signals import SteeringColumnState
from ev_sim.driver.limited_pid import LimitedPid
from ev_sim.driver.profile import check_points, interpolation_parameter


@dataclass(frozen=True, slots=True)
class HandTorqueParameters:
    """Hand torque on the steering wheel over time, left positive."""

    time: tuple[float, ...] = parameter((0.0,), unit="s", about="times of the points, increasing")
    torque: tuple[float, ...] = parameter(
        (0.0,), unit="N m", low=-100.0, high=100.0, about="hand torques at these times; the last one holds"
    )
    interpolation: str = interpolation_parameter("step")

    def __post_init__(self) -> None:
        check_points("time", self.time, "torque", self.torque)


@dataclass(frozen=True, slots=True)
class WantedAngleParameters:
    """Wanted road-wheel angle over time, left positive."""

    time: tuple[float, ...] = parameter((0.0,), unit="s", about="times of the points, increasing")
    angle: tuple[float, ...] = parameter(
        (0.0,), unit="rad", low=-1.5, high=1.5, about="road-wheel angles at these times; the last one holds"
    )
    interpolation: str = interpolation_parameter("step")

    def __post_init__(self) -> None:
        check_points("time", self.time, "angle", self.angle)


@dataclass(frozen=True, slots=True)
class AngleControlParameters:
    """How the driver turns the steering wheel to an angle; stable with and without steering assistance."""

    max_rate: float = parameter(
        8.0, unit="rad/s", low=0.01, high=100.0, about="fastest turning of the steering wheel", source="assumption"
    )
    max_hand_torque: float = parameter(
        8.0, unit="N m", low=0.0, high=100.0, about="largest hand torque, either way", source="assumption"
    )
    proportional_gain: float = parameter(
        0.2, unit="N m/rad", low=0.0, high=100.0, about="torque per angle error", source="assumption"
    )
    integral_gain: float = parameter(
        0.5, unit="N m/(rad s)", low=0.0, high=100.0, about="torque per integral of the error", source="assumption"
    )
    derivative_gain: float = parameter(
        0.03, unit="N m s/rad", low=0.0, high=100.0, about="torque per rate of the error", source="assumption"
    )


@dataclass(frozen=True, slots=True)
class SteeringParameters:
    """Which of the two profiles the hands follow, and how."""

    mode: str = parameter(
        "angle",
        choices=("hand_torque", "angle"),
        about="hand_torque: the given hand torque; angle: turn to the given road-wheel angle",
    )
    hand_torque: HandTorqueParameters = group(HandTorqueParameters)
    wanted_angle: WantedAngleParameters = group(WantedAngleParameters)
    angle_control: AngleControlParameters = group(AngleControlParameters)


@dataclass(slots=True)
class AngleControlState:
    """Rate-limited steering-wheel angle that the driver is turning to [rad], and integral part [N m]."""

    reference: float = 0.0
    integral: float = 0.0


class AngleControl:
    """Turn the steering wheel to an angle: PID control behind a rate-limited reference.

    The driver feels and sees the steering wheel only and knows nothing of what moves it.
    """

    def __init__(self, parameters: AngleControlParameters, period: float) -> None:
        p = parameters
        self._controller = LimitedPid(p.proportional_gain, p.integral_gain, p.derivative_gain, period)
        self._max_change = p.max_rate * period
        self._max_hand_torque = p.max_hand_torque
        self._period = period

    def step(self, wanted_angle: float, column: SteeringColumnState, state: AngleControlState) -> float:
        """Hand torque [N m] towards a wanted steering-wheel angle [rad]; goes on with the state."""
        limit, change = self._max_hand_torque, wanted_angle - state.reference
        change = min(max(change, -self._max_change), self._max_change)
        state.reference += change
        hand_torque, state.integral = self._controller.step(
            state.reference - column.angle, change / self._period - column.rate, state.integral, -limit, limit
        )
        return hand_torque
