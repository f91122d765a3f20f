"""A driver who follows a path by eye, and a speed or a pedal profile by foot."""

from __future__ import annotations

from dataclasses import dataclass, field

from ev_msgs_py.methods import method
from ev_msgs_py.signals import BodyPose, BodyVelocity, DriverCommand, Instant, SteeringColumnState
from ev_msgs_py.vehicle import Vehicle
from ev_sim.driver.lane_keeping import LaneKeeping, LaneKeepingParameters, LaneKeepingState
from ev_sim.driver.pedal_profile import Feet, FeetParameters, FeetState
from ev_sim.driver.profile_file import with_speed_profile_from_file


@dataclass(frozen=True, slots=True)
class PathFollowerParameters(FeetParameters, LaneKeepingParameters):
    """The path, how far ahead the driver looks, and hands and feet."""


@dataclass(slots=True)
class PathFollowerState:
    """State of the feet and of the hands."""

    feet: FeetState = field(default_factory=FeetState)
    hands: LaneKeepingState = field(default_factory=LaneKeepingState)


@method("driver", "path_follower")
class PathFollower:
    """Steer along a path by pure pursuit through the hand torque, forwards and in reverse.

    Raises ParameterError if the parameters name a profile file that has not been read (`load_files`).
    """

    parameters = PathFollowerParameters

    load_files = staticmethod(with_speed_profile_from_file)

    def __init__(self, parameters: PathFollowerParameters, vehicle: Vehicle, period: float) -> None:
        self._feet = Feet(parameters, period)
        self._hands = LaneKeeping(parameters, vehicle, period)
        self.state = PathFollowerState()

    def step(self, now: Instant, body: BodyVelocity, pose: BodyPose, column: SteeringColumnState) -> DriverCommand:
        """Pedals from the speed along the path and the time, hand torque from the place of the car beside its path."""
        s = self.state
        drive, brake = self._feet.step(now.time, body.along_path, s.feet)
        return DriverCommand(drive, brake, self._hands.step(pose, body.along_path, column, s.hands))
