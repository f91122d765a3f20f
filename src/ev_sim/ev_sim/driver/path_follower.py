"""A driver who follows a path by eye, and a speed or a pedal profile by foot."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass, field

from ev_msgs_py.methods import method
from ev_msgs_py.parameters import group
from ev_msgs_py.signals import BodyPose, BodyVelocity, DriverCommand, Instant, SteeringColumnState
from ev_msgs_py.vehicle import Vehicle
from ev_sim.driver.path import Path, PathParameters
from ev_sim.driver.pedal_profile import Feet, FeetParameters, FeetState
from ev_sim.driver.profile_file import with_profile_from_file
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


@dataclass(frozen=True, slots=True)
class PathFollowerParameters(FeetParameters):
    """The path, how far ahead the driver looks, and hands and feet."""

    path: PathParameters = group(PathParameters)
    pursuit: PurePursuitParameters = group(PurePursuitParameters)
    hands: HandParameters = group(HandParameters)


@dataclass(slots=True)
class PathFollowerState:
    """State of the feet and of the hands, and the leg of the path that is reached."""

    feet: FeetState = field(default_factory=FeetState)
    hands: AngleControlState = field(default_factory=AngleControlState)
    leg: int = 0


@method("driver", "path_follower")
class PathFollower:
    """Steer along a path by pure pursuit through the hand torque, forwards and in reverse.

    Raises ParameterError if the parameters name a profile file that has not been read (`load_files`).
    """

    parameters = PathFollowerParameters

    @staticmethod
    def load_files(parameters: PathFollowerParameters) -> PathFollowerParameters:
        """The parameters with the profile from its file, if they name one; see `with_profile_from_file`."""
        return dataclasses.replace(parameters, speed_profile=with_profile_from_file(parameters.speed_profile))

    def __init__(self, parameters: PathFollowerParameters, vehicle: Vehicle, period: float) -> None:
        self._ratio = vehicle.steering_ratio
        self._feet = Feet(parameters, period)
        self._eyes = PurePursuit(parameters.pursuit, Path(parameters.path), vehicle)
        self._hands = AngleControl(parameters.hands.angle_control, period)
        self.state = PathFollowerState()

    def step(self, now: Instant, body: BodyVelocity, pose: BodyPose, column: SteeringColumnState) -> DriverCommand:
        """Pedals from the speed along the path and the time, hand torque from the place of the car beside its path."""
        s = self.state
        drive, brake = self._feet.step(now.time, body.along_path, s.feet)
        angle, s.leg = self._eyes.step(pose, body.along_path, s.leg)
        return DriverCommand(drive, brake, self._hands.step(self._ratio * angle, column, s.hands))
