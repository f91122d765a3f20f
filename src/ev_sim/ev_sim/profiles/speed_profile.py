"""A speed that somebody wants, over time."""

from __future__ import annotations

from dataclasses import dataclass

from ev_msgs_py.parameters.declaration import ParameterError, parameter
from ev_sim.profiles.profile import Profile, check_points, interpolation_parameter, profile_of


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


def wanted_speed(parameters: SpeedProfileParameters, name: str = "speed_profile") -> Profile:
    """The speed over time [m/s].

    ParameterError if the parameters, called `name`, still name a file: whoever made them has to read it.
    """
    if parameters.file:
        raise ParameterError(f"{name}.file: {parameters.file} has not been read into time and speed")
    return profile_of(parameters.time, parameters.speed, parameters.interpolation)
