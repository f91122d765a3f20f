"""Hands that keep the car on its path while the feet drive a cycle."""

from __future__ import annotations

from dataclasses import dataclass, field

from ev_msgs_py.parameters import group
from ev_msgs_py.signals import BodyPose, SteeringColumnState
from ev_msgs_py.vehicle import Vehicle
from ev_sim.driver.path import Path, PathParameters
from ev_sim.driver.pure_pursuit import PurePursuit, PurePursuitParameters
from ev_sim.driver.steering import AngleControl, AngleControlParameters, AngleControlState


@dataclass(frozen=True, slots=True)
class HandParameters:
    """How the driver turns the steering wheel; more firmly than who parks, to answer within tenths of a second."""

    angle_control: AngleControlParameters = group(
        AngleControlParameters,
        max_rate=15.0,
        max_hand_torque=20.0,
        proportional_gain=3.0,
        integral_gain=6.0,
        derivative_gain=0.3,
    )


@dataclass(frozen=True)  # without slots, to be a second base of other parameters
class LaneKeepingParameters:
    """The path (along the x axis by default), how far ahead the driver looks, and how the hands turn."""

    path: PathParameters = group(PathParameters)
    pursuit: PurePursuitParameters = group(PurePursuitParameters)
    hands: HandParameters = group(HandParameters)


@dataclass(slots=True)
class LaneKeepingState:
    """State of the hands, and the leg of the path that is reached."""

    hands: AngleControlState = field(default_factory=AngleControlState)
    leg: int = 0


class LaneKeeping:
    """Hand torque that leads the car along its path by pure pursuit."""

    def __init__(self, parameters: LaneKeepingParameters, vehicle: Vehicle, period: float) -> None:
        self._ratio = vehicle.steering_ratio
        self._eyes = PurePursuit(parameters.pursuit, Path(parameters.path), vehicle)
        self._hands = AngleControl(parameters.hands.angle_control, period)

    def step(self, pose: BodyPose, speed: float, column: SteeringColumnState, state: LaneKeepingState) -> float:
        """Hand torque [N m] at a speed along the path [m/s]; goes on with the state."""
        angle, state.leg = self._eyes.step(pose, speed, state.leg)
        return self._hands.step(self._ratio * angle, column, state.hands)
