"""The pedals of standard manoeuvres: hold a speed, then press or release the pedals regardless of what follows."""

from __future__ import annotations

from dataclasses import dataclass

from ev_msgs_py.parameters import group, parameter
from ev_sim.driver.profile import Profile, check_points, interpolation_parameter
from ev_sim.driver.speed_control import (
    SpeedControl,
    SpeedControlParameters,
    SpeedProfileParameters,
    refuse_unread_file,
)


@dataclass(frozen=True, slots=True)
class PedalProfileParameters:
    """Drive and brake torque over the time since the driver stopped to care about the speed."""

    begin: bool = parameter(False, about="false: follow the speed profile throughout; true: change to these pedals")
    begin_time: float = parameter(0.0, unit="s", low=0.0, high=1e5, about="not before this time")
    begin_speed: float = parameter(
        0.0, unit="m/s", low=0.0, high=100.0, about="not before the car is this fast, either way"
    )
    time: tuple[float, ...] = parameter((0.0,), unit="s", about="times of the points since then, increasing")
    drive_torque: tuple[float, ...] = parameter(
        (0.0,), unit="N m", low=-1e6, high=1e6, about="drive torques at these times, of all wheels together"
    )
    brake_torque: tuple[float, ...] = parameter(
        (0.0,), unit="N m", low=0.0, high=1e6, about="brake torques at these times, of all wheels together"
    )
    interpolation: str = interpolation_parameter("linear")

    def __post_init__(self) -> None:
        check_points("time", self.time, "drive_torque", self.drive_torque)
        check_points("time", self.time, "brake_torque", self.brake_torque)


@dataclass(frozen=True, slots=True)
class FeetParameters:
    """The speed to follow, how, and the pedals that may take its place."""

    speed_profile: SpeedProfileParameters = group(SpeedProfileParameters)
    speed_control: SpeedControlParameters = group(SpeedControlParameters)
    pedals: PedalProfileParameters = group(PedalProfileParameters)


@dataclass(slots=True)
class FeetState:
    """Integral part of the speed control [N m], and when the pedal profile began [s], None before."""

    speed_integral: float = 0.0
    begun: float | None = None


class Feet:
    """Follow the speed profile until the pedal profile begins, then follow that.

    ParameterError if the speed profile names a file that has not been read.
    """

    def __init__(self, parameters: FeetParameters, period: float) -> None:
        wanted, pedals = parameters.speed_profile, parameters.pedals
        refuse_unread_file(wanted)
        self._wanted_speed = wanted.profile()
        self._control = SpeedControl(parameters.speed_control, period)
        self._pedals = pedals
        self._drive_torque = Profile(pedals.time, pedals.drive_torque, pedals.interpolation)
        self._brake_torque = Profile(pedals.time, pedals.brake_torque, pedals.interpolation)

    def step(self, t: float, speed: float, state: FeetState) -> tuple[float, float]:
        """Drive and brake torque [N m] at the time t [s] and the speed along the path [m/s]; goes on with the state."""
        pedals = self._pedals
        if state.begun is None and pedals.begin and t >= pedals.begin_time and abs(speed) >= pedals.begin_speed:
            state.begun = t
        if state.begun is not None:
            since = t - state.begun
            return self._drive_torque.at(since), self._brake_torque.at(since)
        drive, brake, state.speed_integral = self._control.step(self._wanted_speed.at(t), speed, state.speed_integral)
        return drive, brake
