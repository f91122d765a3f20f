"""Traction control by accelerations: their ratio (dissertation, eq 1.4), or a torque (eq 1.7)."""

from __future__ import annotations

from dataclasses import dataclass
from enum import auto
from math import inf

from ev_control.estimation.wheel_dynamics import (
    Filtered,
    WheelMotion,
    filter_share,
    follow,
    mass_share,
    road_torque,
)
from ev_control.law import (
    LimitedWheel,
    LimpModeParameters,
    ReferenceSpeedParameters,
    traction_control,
)
from ev_control.shared import wheel_regulation as criterion
from ev_core.law import Car, Choice, Vehicle, compilable, entry, group, parameter, part
from ev_core.vehicle.driveline import has_own_motors


@dataclass(frozen=True, slots=True)
class AccelerationRatioParameters(criterion.AccelerationCriterionParameters):
    """The ratio that separates slip from grip, and how the limit moves."""

    fall: float = parameter(
        8000.0, unit="N m/s", low=1.0, high=1e6, about="fall of the limit while the wheel slips"
    )
    rise: float = parameter(
        500.0, unit="N m/s", low=1.0, high=1e6, about="rise of the limit while it grips"
    )
    reference: ReferenceSpeedParameters = group(ReferenceSpeedParameters)
    limp: LimpModeParameters = group(LimpModeParameters)


@dataclass(slots=True)
class RatioWheel(LimitedWheel):
    """State of a wheel."""

    accelerations: criterion.Accelerations = part(criterion.Accelerations)


@traction_control("acceleration_ratio")
@compilable
def acceleration_ratio(
    p: AccelerationRatioParameters,
    car: Car,
    w: RatioWheel,
    period: float,
    motion: WheelMotion,
    wanted: float,
) -> float:
    """Lower a wheel's torque limit while the wheel outruns the car, a_x/w' < threshold.

    A rolling wheel has a_x/w' = r, a slipping one less (dissertation, eq 1.4). The source wants to
    intervene where the ratio exceeds 0.4 m, which for its wheel of 0.32 m never happens, and prints
    a_x/w' < 0.4, which is always true; the sign of eq 1.4 is right, the value is not. The ratio is
    compared without dividing, only while the wheel accelerates more than noise does, and once it
    has gained more on the car than a tyre that grips. It sees slip that grows, not slip: a wheel
    that spins at a steady speed is left to spin, and the slip that built up before the limit fell
    stays.
    """
    if criterion.gains_on_car(p, car, w.accelerations, period, motion):
        return min(w.limit, wanted) - p.fall * period
    raised = w.limit + p.rise * period
    return raised if raised < wanted else inf


class Limits(Choice):
    """Times at which the transmissible torque is a limit."""

    WHILE_GAINING = auto()
    ALWAYS = auto()


@dataclass(frozen=True, slots=True)
class TransmissibleParameters(criterion.GainedSpeedParameters):
    """The relaxation factor, and when the limit counts; the source gives none of them."""

    limits: Limits = parameter(
        Limits.WHILE_GAINING,
        about="while_gaining: only while the tread gains on the car by more than `margin`, then "
        "rising; always: at every instant",
        source="always: Yin, Oh and Hori (2009); while_gaining: assumption",
    )
    relaxation: float = parameter(
        0.9,
        unit="1",
        low=0.1,
        high=1.0,
        about="allowed acceleration of the car over that of the tyre's tread, a/r",
    )
    filter_time: float = parameter(
        0.03, unit="s", low=0.0, high=1.0, about="time constant of force and accelerations"
    )
    margin: float = parameter(
        1.0,
        unit="m/s^2",
        low=0.0,
        high=50.0,
        about="while_gaining: excess acceleration of the tread that is noise",
    )
    rise: float = parameter(
        1000.0,
        unit="N m/s",
        low=1.0,
        high=1e6,
        about="while_gaining: rise of the limit while the wheel follows the car; by eq 1.7 alone, "
        "no force stays none",
    )
    compensation: float = parameter(
        0.15,
        unit="s",
        low=0.0,
        high=10.0,
        about="always: of the filtered rate of the request, added to the limit while the tyre "
        "grips, so that filter, drive and carcass do not hold back a pedal that is pressed",
        source="Yin, Oh and Hori (2009) add it; its value, and that it ends with the grip, are "
        "assumptions",
    )
    reference: ReferenceSpeedParameters = group(ReferenceSpeedParameters)
    limp: LimpModeParameters = group(LimpModeParameters)


@dataclass(slots=True)
class TransmissibleWheel(LimitedWheel):
    """State of a wheel."""

    road: Filtered = part(Filtered)  # torque that the road takes [N m]
    tread_acceleration: Filtered = part(Filtered)  # [m/s^2]
    body_acceleration: Filtered = part(Filtered)  # of the car [m/s^2]
    gained: float = entry(unit="rad/s", about="speed that the wheel has gained on the car lately")
    asked: float = entry(unit="N m", about="last request")
    rate: float = entry(unit="N m/s", about="of the request, filtered")


def own_motors_to_limit_always(parameters: TransmissibleParameters, vehicle: Vehicle) -> str:
    """Refuse engines and differentials, behind which the torque of a wheel comes too late."""
    if parameters.limits != Limits.ALWAYS or (
        has_own_motors(vehicle) and vehicle.engine.peak_power == 0.0
    ):
        return ""
    return "a motor for each driven wheel for limits always"


@traction_control("maximum_transmissible_torque", needs=(own_motors_to_limit_always,))
@compilable
def maximum_transmissible_torque(
    p: TransmissibleParameters,
    car: Car,
    w: TransmissibleWheel,
    period: float,
    motion: WheelMotion,
    wanted: float,
) -> float:
    """Limit a wheel to the torque that lets it and the car accelerate in a fixed proportion.

    T = (J/(alpha M r^2) + 1) r F_d, with the force F_d = (M_w - J w')/r: with it the tread
    accelerates 1/alpha times as fast as the car (dissertation, eq 1.7). The source prints r where
    r^2 belongs if the factor is the pure number alpha; with its own definition, a_x/w' [m] = alpha
    r, the printed r is right. M is what one wheel moves, not the whole car. No speed of the car is
    needed but for the direction, and like every law that only knows accelerations this one keeps
    slip from growing but does not undo it.

    Yin, Oh and Hori (2009), after whom the law is named, limit `always`, T + G dT*/dt with the rate
    of the request. `while_gaining` limits only a tread that gains on the car by more than `margin`,
    so that slip which grows more slowly is not seen. In both a tyre that grips may gain what it
    needs for its force.
    """
    share, radius = filter_share(period, p.filter_time), car.wheel_radius
    road = follow(w.road, road_torque(car, motion), share)
    tread = follow(w.tread_acceleration, radius * motion.acceleration, share)
    body = follow(w.body_acceleration, motion.body_acceleration, share)
    slips = criterion.has_gained(p, car, w, period, motion)
    # Inertia of the wheel over that of what it moves, with the relaxed proportion.
    ratio = car.driven_wheel_inertia[motion.place] / (
        p.relaxation * mass_share(car) * (radius * radius)
    )
    # A road that pushes the wheel, as on the overrun, transmits no drive torque.
    transmissible = (ratio + 1.0) / car.motor.gear_efficiency * max(road, 0.0)
    if p.limits == Limits.ALWAYS:
        w.rate += share * ((wanted - w.asked) / period - w.rate)
        w.asked = wanted
        # A pedal that is released needs no help.
        return transmissible if slips else transmissible + p.compensation * max(w.rate, 0.0)
    if slips and p.relaxation * tread > body + p.margin:
        return transmissible
    raised = w.limit + p.rise * period
    return raised if raised < wanted else inf
