"""The driver's feet: follow a speed by drive torque, regeneration and brakes (PI speed control of Shchur 2019)."""

from __future__ import annotations

import math
from dataclasses import dataclass

from ev_msgs_py.parameters import ParameterError, parameter
from ev_sim.driver.limited_pid import LimitedPid
from ev_sim.driver.profile import Profile, check_points, interpolation_parameter


@dataclass(frozen=True, slots=True)
class SpeedProfileParameters:
    """The speed that the driver wants, over time; the default is that of the paper's cycle."""

    time: tuple[float, ...] = parameter(
        (0.0, 4.0, 25.0, 29.0), unit="s", about="times of the points, increasing", source="Shchur 2019, fig. 4"
    )
    speed: tuple[float, ...] = parameter(
        (0.0, 15 / 3.6, 15 / 3.6, 30 / 3.6),
        unit="m/s",
        low=-100.0,
        high=100.0,
        about="speeds at these times, negative to reverse; the last one holds",
        source="Shchur 2019, fig. 4",
    )
    interpolation: str = interpolation_parameter("linear")
    file: str = parameter(
        "", about="CSV file with the columns t_s and v_kmh or v_mps, instead of time and speed; empty for none"
    )

    def __post_init__(self) -> None:
        check_points("time", self.time, "speed", self.speed)

    def profile(self) -> Profile:
        """The speed over time [m/s]."""
        return Profile(self.time, self.speed, self.interpolation)


@dataclass(frozen=True, slots=True)
class SpeedControlParameters:
    """PI control of the speed and what the pedals can ask for; all torques are sums over the wheels.

    The paper names the PI controller but gives neither gains nor limits. The gains suit a car of 1400 kg.
    """

    proportional_gain: float = parameter(
        2000.0, unit="N m s/m", low=0.0, high=1e6, about="torque per speed error", source="assumption"
    )
    integral_gain: float = parameter(
        1000.0, unit="N m/m", low=0.0, high=1e6, about="torque per integral of the speed error", source="assumption"
    )
    max_drive_torque: float = parameter(
        1500.0, unit="N m", low=0.0, high=1e6, about="limit when driving, forwards or backwards", source="assumption"
    )
    max_regenerative_torque: float = parameter(
        600.0,
        unit="N m",
        low=0.0,
        high=1e6,
        about="limit of the drives when they slow the car down; beyond it the friction brakes take over",
        source="assumption",
    )
    max_brake_torque: float = parameter(
        4000.0, unit="N m", low=0.0, high=1e6, about="limit of the friction brakes, about 1 g", source="assumption"
    )
    holding_brake_torque: float = parameter(
        500.0, unit="N m", low=0.0, high=1e6, about="brake torque while the driver wants to stand", source="assumption"
    )
    standstill_speed: float = parameter(
        0.05, unit="m/s", low=0.0, high=1.0, about="speed below which the car counts as standing", source="assumption"
    )


class SpeedControl:
    """Ask for drive and brake torque so that the car follows a wanted speed.

    A PI controller (Shchur 2019, fig. 3) gives the wanted torque. In the direction of travel it goes to the drives;
    against it, to the drives up to the regenerative limit, and the rest to the friction brakes. A driver who wants to
    stand, and does, lets go of the drives and holds the brake.
    """

    def __init__(self, parameters: SpeedControlParameters, period: float) -> None:
        self._p = parameters
        self._controller = LimitedPid(parameters.proportional_gain, parameters.integral_gain, 0.0, period)

    def step(self, wanted_speed: float, speed: float, integral: float) -> tuple[float, float, float]:
        """Drive torque (positive forwards), brake torque (never negative) and new integral part [N m]; speeds [m/s]."""
        p = self._p
        error = wanted_speed - speed
        if abs(speed) <= p.standstill_speed:
            if wanted_speed == 0.0:
                return 0.0, p.holding_brake_torque, 0.0
            torque, integral = self._controller.step(error, 0.0, integral, -p.max_drive_torque, p.max_drive_torque)
            return torque, 0.0, integral
        slowing = p.max_regenerative_torque + p.max_brake_torque
        low, high = (-slowing, p.max_drive_torque) if speed > 0.0 else (-p.max_drive_torque, slowing)
        torque, integral = self._controller.step(error, 0.0, integral, low, high)
        brake = abs(torque) - p.max_regenerative_torque
        if torque * speed >= 0.0 or brake <= 0.0:
            return torque, 0.0, integral
        return math.copysign(p.max_regenerative_torque, torque), brake, integral


def refuse_unread_file(profile: SpeedProfileParameters, name: str = "speed_profile") -> None:
    """ParameterError if the profile of this name still names a file: whoever made the parameters has to read it."""
    if profile.file:
        raise ParameterError(f"{name}.file: {profile.file} has not been read into time and speed")
