"""A driver who follows a speed over time, and steers by hand torque or to a road-wheel angle over time."""

from __future__ import annotations

from dataclasses import dataclass, field

from ev_msgs_py.methods import method
from ev_msgs_py.parameters import group
from ev_msgs_py.signals import BodyVelocity, DriverCommand, Instant, SteeringColumnState
from ev_msgs_py.vehicle import Vehicle
from ev_sim.driver.profile import Profile
from ev_sim.driver.profile_file import with_speed_profile_from_file
from ev_sim.driver.speed_control import SpeedControl, SpeedControlParameters, SpeedProfileParameters, refuse_unread_file
from ev_sim.driver.steering import AngleControl, AngleControlState, SteeringParameters


@dataclass(frozen=True, slots=True)
class SpeedProfileDriverParameters:
    """What the driver wants, and how feet and hands go about it."""

    speed_profile: SpeedProfileParameters = group(SpeedProfileParameters)
    speed_control: SpeedControlParameters = group(SpeedControlParameters)
    steering: SteeringParameters = group(SteeringParameters)


@dataclass(slots=True)
class SpeedProfileDriverState:
    """Integral part of the speed control [N m], and the state of the hands."""

    speed_integral: float = 0.0
    hands: AngleControlState = field(default_factory=AngleControlState)


@method("driver", "speed_profile")
class SpeedProfileDriver:
    """Follow a speed profile, and steer by a hand torque profile or to a road-wheel angle profile.

    Raises ParameterError if the parameters name a profile file that has not been read (`load_files`).
    """

    parameters = SpeedProfileDriverParameters

    load_files = staticmethod(with_speed_profile_from_file)

    def __init__(self, parameters: SpeedProfileDriverParameters, vehicle: Vehicle, period: float) -> None:
        wanted, steering = parameters.speed_profile, parameters.steering
        refuse_unread_file(wanted)
        self._ratio = vehicle.steering_ratio
        self._wanted_speed = wanted.profile()
        self._feet = SpeedControl(parameters.speed_control, period)
        self._turns_to_angle = steering.mode == "angle"
        torque, angle = steering.hand_torque, steering.wanted_angle
        self._hand_torque = Profile(torque.time, torque.torque, torque.interpolation)
        self._wanted_angle = Profile(angle.time, angle.angle, angle.interpolation)
        self._hands = AngleControl(steering.angle_control, period)
        self.state = SpeedProfileDriverState()

    def step(self, now: Instant, body: BodyVelocity, column: SteeringColumnState) -> DriverCommand:
        """Pedals from the speed along the path, hand torque from the profile or from the steering-wheel angle."""
        s, t = self.state, now.time
        drive, brake, s.speed_integral = self._feet.step(self._wanted_speed.at(t), body.along_path, s.speed_integral)
        if self._turns_to_angle:
            hand_torque = self._hands.step(self._ratio * self._wanted_angle.at(t), column, s.hands)
        else:
            hand_torque = self._hand_torque.at(t)
        return DriverCommand(drive, brake, hand_torque)
