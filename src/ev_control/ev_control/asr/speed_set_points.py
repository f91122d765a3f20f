"""Traction controls by speed set-points, for drives in speed mode (dissertation, 1.4 and 2.4)."""

from __future__ import annotations

from dataclasses import dataclass
from enum import auto

from ev_control.estimation.wheel_dynamics import WheelMotion, slip_of
from ev_control.law import (
    SlipThresholdParameters,
    SpeedSetPointParameters,
    SpeedSetPointWheel,
    moved,
    serves_request,
    traction_control,
)
from ev_control.shared.wheel_regulation import (
    AccelerationCriterionParameters,
    Accelerations,
    gains_on_car,
)
from ev_core.law import Car, Choice, ParameterError, compilable, group, parameter, part


class Regime(Choice):
    """Uses of the car; the source does not name its four regimes."""

    ROAD = auto()
    SPORT = auto()
    WINTER = auto()
    TERRAIN = auto()


@dataclass(frozen=True, slots=True)
class RatioSetPointParameters(SpeedSetPointParameters):
    """The ratio that separates slip from grip, and how the set-point moves."""

    criterion: AccelerationCriterionParameters = group(AccelerationCriterionParameters)


@dataclass(slots=True)
class RatioSetPointWheel(SpeedSetPointWheel):
    """State of a wheel."""

    accelerations: Accelerations = part(Accelerations)


@traction_control("speed_by_acceleration_ratio", speed_mode=True)
@compilable
def speed_by_acceleration_ratio(
    p: RatioSetPointParameters,
    car: Car,
    w: RatioSetPointWheel,
    period: float,
    motion: WheelMotion,
    wanted: float,
) -> float:
    """Lower a wheel's speed set-point while the wheel outruns the car, a_x/w' < threshold.

    Principle 1 of slip control, by forecast (dissertation, eq 1.4 and section 2.4; the threshold as
    in `acceleration_ratio`). The drive is in speed mode. What the text leaves open: where the
    set-point begins (at the speed of the wheel), how fast it falls, and that it rises while the
    criterion does not hold.
    """
    gains = gains_on_car(p.criterion, car, w.accelerations, period, motion)
    # The criterion has no range to stay in: where slip does not grow, the set-point rises to find
    # the limit.
    course = -1.0 if gains else 1.0
    return moved(p, w, period, motion, course, serves_request(p, car, motion, wanted))


@dataclass(frozen=True, slots=True)
class SpeedBySlipParameters(SpeedSetPointParameters):
    """The range of the slip, and how the set-point moves."""

    thresholds: SlipThresholdParameters = group(SlipThresholdParameters)


@traction_control("speed_by_slip", speed_mode=True)
@compilable
def speed_by_slip(
    p: SpeedBySlipParameters,
    car: Car,
    w: SpeedSetPointWheel,
    period: float,
    motion: WheelMotion,
    wanted: float,
) -> float:
    """Lower a wheel's speed set-point above a slip of 0.15..0.19, raise it below.

    Principle 2 of slip control, by the slip itself (dissertation, eq 1.5 and section 2.4): a slip
    that exceeds the range lowers the set-point. The drive is in speed mode. What the text leaves
    open: where the set-point begins (at the speed of the wheel), how fast it falls, and that below
    the range it rises.
    """
    # Within the range the set-point stays.
    slip, course = slip_of(motion, p.slowest), 0.0
    if slip > p.thresholds.high:
        course = -1.0
    elif slip < p.thresholds.low:
        course = 1.0
    return moved(p, w, period, motion, course, serves_request(p, car, motion, wanted))


@dataclass(frozen=True, slots=True)
class Corridor:
    """Bounds of the wheel speed over the speed at which the wheel would roll, less 1."""

    low: float = parameter(0.05, unit="1", low=0.0, high=10.0, about="lower bound")
    high: float = parameter(0.15, unit="1", low=0.0, high=10.0, about="upper bound")

    def __post_init__(self) -> None:
        if self.low > self.high:
            raise ParameterError(f"low is {self.low:g}, expected at most high, {self.high:g}")


@dataclass(frozen=True, slots=True)
class SpeedCorridorParameters(SpeedSetPointParameters):
    """Corridors of four regimes forwards and one in reverse, of which the source gives none."""

    regime: Regime = parameter(
        Regime.ROAD, about="forwards, by what the car is used for", source="assumption: the names"
    )
    road: Corridor = group(Corridor)
    sport: Corridor = group(Corridor, low=0.1, high=0.22)
    winter: Corridor = group(Corridor, low=0.03, high=0.1)
    terrain: Corridor = group(Corridor, low=0.2, high=0.4)
    reverse: Corridor = group(Corridor, low=0.03, high=0.1)


@traction_control("speed_corridor", speed_mode=True)
@compilable
def speed_corridor(
    p: SpeedCorridorParameters,
    car: Car,
    w: SpeedSetPointWheel,
    period: float,
    motion: WheelMotion,
    wanted: float,
) -> float:
    """Lower a wheel's torque above the speed corridor of the regime, raise it below.

    The drive is commanded by a speed set-point, so its torque falls and rises with that
    (dissertation, section 1.4, without numbers). The corridor goes with the speed at which a wheel
    of the nominal radius would roll: torques drift apart where radii differ, as in the source;
    counting slip instead only helps if it knows each radius. At walking speed bounds are taken of
    `slowest`.
    """
    low, high = p.road.low, p.road.high
    # The four regimes are those of driving forwards.
    if motion.ahead < 0.0:
        low, high = p.reverse.low, p.reverse.high
    elif p.regime == Regime.SPORT:
        low, high = p.sport.low, p.sport.high
    elif p.regime == Regime.WINTER:
        low, high = p.winter.low, p.winter.high
    elif p.regime == Regime.TERRAIN:
        low, high = p.terrain.low, p.terrain.high
    ahead_of_rolling = motion.speed - motion.rolling
    unit = max(motion.rolling, p.slowest)
    course = 0.0
    if ahead_of_rolling > high * unit:
        course = -1.0
    elif ahead_of_rolling < low * unit:
        course = 1.0
    return moved(p, w, period, motion, course, serves_request(p, car, motion, wanted))
