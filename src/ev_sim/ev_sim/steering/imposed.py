"""Road wheels that stand at an angle over time, such as a measured one."""

from __future__ import annotations

from dataclasses import dataclass

from ev_core.law import Car, Vehicle, compilable, entry, setting
from ev_msgs_py.contract.signals import DriverCommand, SteeringColumnState
from ev_sim.profiles.profile import (
    Profile,
    check_points,
    interpolation_parameter,
    profile_of,
    value_at,
)
from ev_sim.steering.column import steering_column


@dataclass(frozen=True, slots=True)
class ImposedAngleParameters:
    """The mean angle of the front wheels, and what the sensor that gave it may have made of it."""

    time: tuple[float, ...] = setting((0.0,), unit="s", about="times of the points, increasing")
    angle: tuple[float, ...] = setting(
        (0.0,),
        unit="rad",
        low=-1.4,
        high=1.4,
        about="mean road-wheel angles at these times",
        lateral=True,
    )
    interpolation: str = interpolation_parameter("linear")
    scale: float = setting(1.0, unit="1", low=0.5, high=2.0, about="true angle over the given one")
    offset: float = setting(
        0.0, unit="rad", low=-0.1, high=0.1, about="added to the scaled angle", lateral=True
    )
    delay: float = setting(
        0.0,
        unit="s",
        low=-0.5,
        high=0.5,
        about="by which the true angle is later than the given one; negative: earlier",
    )

    def __post_init__(self) -> None:
        check_points("time", self.time, "angle", self.angle)


@dataclass(slots=True)
class ImposedAngleState:
    """The time."""

    periods: float = entry(unit="1", about="number of periods so far")


def angles(parameters: ImposedAngleParameters, vehicle: Vehicle, period: float) -> Profile:
    """The given angle over time [rad]."""
    return profile_of(parameters.time, parameters.angle, parameters.interpolation)


@compilable
def shown(
    p: ImposedAngleParameters, car: Car, c: Profile, s: ImposedAngleState, period: float
) -> SteeringColumnState:
    """The angle at this instant, and the rate that leads to the next one, without hand torque."""
    now = s.periods * period - p.delay
    angle = p.scale * value_at(c, now) + p.offset
    rate = p.scale * (value_at(c, now + period) - value_at(c, now)) / period
    return SteeringColumnState(
        car.steering_ratio * angle, car.steering_ratio * rate, 0.0, angle, rate
    )


@steering_column("imposed", parameters=ImposedAngleParameters, prepare=angles, outputs=shown)
@compilable
def imposed(s: ImposedAngleState, driver: DriverCommand) -> None:
    """Follow a road-wheel angle over time, whatever hands and road do, to replay a measured one."""
    s.periods += 1.0
