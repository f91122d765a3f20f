"""Friction of the road, learnt under slipping wheels, and stored diagrams of it over slip.

The dissertation (section 1.4) names stored phi-s diagrams and gives none. Here they are one family:
the resultant slip s_r = sqrt(s^2 + tan(alpha)^2) uses mu = mu_max 2 x/(1 + x^2), x = s_r/s_p, up to
its peak at s_p and mu_max beyond, in the direction of the slip vector. s_p = first + growth mu_max
follows the peaks of Burckhardt's curves.
"""

from dataclasses import dataclass

from ev_control.estimation.plausible import Sensors, is_plausible
from ev_control.estimation.reference_speed import (
    ReferenceSpeedParameters,
    ReferenceSpeedState,
    rolling_speeds,
)
from ev_control.estimation.wheel_dynamics import filter_share, slowest_wheel, wheel_loads
from ev_core.law import Car, Wheels, compilable, entry, group, parameter, part, per_wheel, sqrt


@dataclass(frozen=True, slots=True)
class FrictionLearningParameters:
    """Learning of the friction under a slipping wheel; the source takes it as known."""

    largest_friction: float = parameter(
        1.2, unit="1", low=0.01, high=3.0, about="friction at the start and at most"
    )
    learning_slip: float = parameter(
        0.15,
        unit="1",
        low=0.01,
        high=1.0,
        about="slip from which on the friction in use is taken for the road's",
    )
    filter_time: float = parameter(
        0.02, unit="s", low=0.0, high=1.0, about="time constant of the friction in use"
    )
    rise: float = parameter(
        0.3,
        unit="1/s",
        low=0.0,
        high=100.0,
        about="rise of the estimate without slip, to find a better road",
    )
    slowest: float = slowest_wheel()


@compilable
def learnt_friction(
    p: FrictionLearningParameters, friction: float, used: float, slips: bool, period: float
) -> float:
    """Friction [1] to believe in after a period, by the one before and the filtered one in use.

    A wheel that slips shows the friction of the road; of one that grips only a value that slowly
    rises is known: a saw tooth, which finds a better road only after a while, and a worse one by
    slipping.
    """
    if slips:
        return min(max(used, 0.0), p.largest_friction)
    return min(friction + p.rise * period, p.largest_friction)


@dataclass(frozen=True, slots=True)
class FrictionEstimateParameters(FrictionLearningParameters):
    """Learning of the friction, and the speed that slip counts against."""

    reference: ReferenceSpeedParameters = group(ReferenceSpeedParameters)


@dataclass(slots=True)
class FrictionEstimateState:
    """State of the friction estimate."""

    friction: list[float] = per_wheel(unit="1", about="estimated friction of the road")
    used: list[float] = per_wheel(unit="1", about="friction in use, filtered")
    velocity: list[float] = per_wheel(unit="rad/s", about="wheel speeds of the step before")
    known: bool = entry(False, unit="1", about="whether there was a step before")
    reference: ReferenceSpeedState = part(ReferenceSpeedState)


def unknown_road(p: FrictionEstimateParameters) -> FrictionEstimateState:
    """The state that believes in the largest friction."""
    return FrictionEstimateState(friction=[p.largest_friction] * 4)


@compilable
def estimated_friction(
    p: FrictionEstimateParameters,
    car: Car,
    s: FrictionEstimateState,
    period: float,
    drive_torque: float,
    sensors: Sensors,
) -> Wheels:
    """Friction [1] of each wheel; of the drive torque of all wheels [N m] only the sign counts.

    mu = (M - J w')/(F_z r) of a wheel that slips; of one that does not, a value that slowly rises
    (assumption), see `learnt_friction`. An absurd measurement changes nothing.
    """
    if not is_plausible(sensors):
        # The next acceleration would be a difference across the gap.
        s.known = False
        return Wheels(s.friction[0], s.friction[1], s.friction[2], s.friction[3])
    velocity, effort = sensors.wheels.velocity, sensors.wheels.effort
    load, radius = wheel_loads(car, sensors.imu), car.wheel_radius
    direction = 0.0
    if drive_torque != 0.0:
        direction = 1.0 if drive_torque > 0.0 else -1.0
    rolling = rolling_speeds(p.reference, car, s.reference, period, sensors, direction)
    share = filter_share(period, p.filter_time)
    for i in range(4):
        # Without torque or load a wheel shows nothing of the road.
        if car.driven[i] and direction != 0.0 and load[i] > 0.0:
            gained = velocity[i] - s.velocity[i] if s.known else 0.0
            # What the road takes is the torque less what speeds the wheel up, counted along the
            # request.
            road = effort[i] - car.driven_wheel_inertia[i] * gained / period
            s.used[i] += share * (direction * road / (load[i] * radius) - s.used[i])
            slip = direction * (velocity[i] - rolling[i]) / max(abs(velocity[i]), p.slowest)
            s.friction[i] = learnt_friction(
                p, s.friction[i], s.used[i], slip > p.learning_slip, period
            )
    s.velocity[:] = velocity
    s.known = True
    return Wheels(s.friction[0], s.friction[1], s.friction[2], s.friction[3])


@dataclass(frozen=True, slots=True)
class FrictionDiagramParameters:
    """Slip of the peak of a diagram."""

    first: float = parameter(
        0.045,
        unit="1",
        low=1e-3,
        high=1.0,
        about="slip of the peak on a road without friction; with the growth it is within 0.01 of "
        "Burckhardt's peaks on snow and wet asphalt",
    )
    growth: float = parameter(
        0.11, unit="1", low=0.0, high=1.0, about="growth of that slip with mu_max"
    )


@compilable
def peak_slip(p: FrictionDiagramParameters, largest: float) -> float:
    """Resultant slip of the peak [1] on a road with this largest friction coefficient [1]."""
    return p.first + p.growth * largest


@compilable
def expected_friction(
    p: FrictionDiagramParameters, largest: float, slip: float, lateral: float
) -> float:
    """Longitudinal friction [1] at a slip and a lateral slip tan(alpha) [1].

    The lateral friction phi_y is the same with both exchanged.
    """
    resultant = sqrt(slip * slip + lateral * lateral)
    if resultant == 0.0:
        return 0.0
    # Beyond its peak the diagram is level.
    x = min(resultant / peak_slip(p, largest), 1.0)
    return largest * (2.0 * x / (1.0 + x * x)) * slip / resultant


@compilable
def friction_at_peak(p: FrictionDiagramParameters, largest: float, lateral: float) -> float:
    """Longitudinal friction [1] at the peak of the slip, beside a lateral slip [1]; zero beyond.

    More slip would turn the rest of the friction along as well, and leave nothing across.
    """
    use = lateral / peak_slip(p, largest)
    return largest * sqrt(max(1.0 - use * use, 0.0))
