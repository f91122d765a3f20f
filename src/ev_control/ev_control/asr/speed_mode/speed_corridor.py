"""Wheel speeds held in a corridor by set-points (dissertation, section 1.4, after its reference 89)."""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.law import SpeedSetPointParameters, SpeedSetPointWheel, WheelMotion, moved
from ev_control.shared.traction_control import traction_control
from ev_core.law import Car, ParameterError, compilable, group, parameter

REGIMES = ("road", "sport", "winter", "terrain")
ROAD, SPORT, WINTER, TERRAIN = range(len(REGIMES))


@dataclass(frozen=True, slots=True)
class Corridor:
    """Bounds of the wheel speed over the speed at which the wheel would roll, less 1."""

    low: float = parameter(0.05, unit="1", low=0.0, high=10.0, about="lower bound")
    high: float = parameter(0.15, unit="1", low=0.0, high=10.0, about="upper bound")

    def __post_init__(self) -> None:
        if self.low > self.high:
            raise ParameterError(f"low is {self.low:g}, allowed is at most high, {self.high:g}")


@dataclass(frozen=True, slots=True)
class SpeedCorridorParameters(SpeedSetPointParameters):
    """Four regimes forwards and one in reverse; their names and corridors, which the source does not give."""

    regime: str = parameter(
        "road", choices=REGIMES, about="forwards, by what the car is used for", source="assumption: the names"
    )
    road: Corridor = group(Corridor)
    sport: Corridor = group(Corridor, low=0.1, high=0.22)
    winter: Corridor = group(Corridor, low=0.03, high=0.1)
    terrain: Corridor = group(Corridor, low=0.2, high=0.4)
    reverse: Corridor = group(Corridor, low=0.03, high=0.1)


@traction_control("speed_corridor", SpeedCorridorParameters, SpeedSetPointWheel, speed_mode=True)
@compilable
def speed_corridor(
    p: SpeedCorridorParameters, car: Car, w: SpeedSetPointWheel, period: float, motion: WheelMotion, wanted: float
) -> float:
    """Lower a wheel's torque while its speed is above the corridor of the regime, raise it below, until it is inside.

    The drive is commanded by a speed set-point, so its torque falls and rises with that (dissertation, section 1.4,
    without numbers). The corridor goes with the speed at which a wheel of the nominal radius would roll: torques drift
    apart where radii differ, as the source says; counting slip instead only helps if it knows each radius. At walking
    speed bounds are taken of `slowest`.
    """
    low, high = p.road.low, p.road.high
    if motion.ahead < 0.0:
        low, high = p.reverse.low, p.reverse.high
    elif p.regime == SPORT:
        low, high = p.sport.low, p.sport.high
    elif p.regime == WINTER:
        low, high = p.winter.low, p.winter.high
    elif p.regime == TERRAIN:
        low, high = p.terrain.low, p.terrain.high
    ahead_of_rolling, unit = motion.speed - motion.rolling, max(motion.rolling, p.slowest)
    course = 0.0
    if ahead_of_rolling > high * unit:
        course = -1.0
    elif ahead_of_rolling < low * unit:
        course = 1.0
    return moved(p, car, w, period, motion, wanted, course)
