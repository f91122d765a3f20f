"""The fastest speed along a closed line that a car can hold.

One pass along the line is for driving, one against it for braking. Kapania, Subosits and Gerdes
(2016), A sequential two-step algorithm for fast generation of vehicle racing trajectories, J. Dyn.
Syst. Meas. Control 138, 091005, section 2: bends by lateral grip alone, then both passes on the
friction ellipse of a point mass, here with the drag of the car and the torque and power of its
motors.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from ev_core.law import GRAVITY, Vehicle, parameter, sqrt
from ev_core.vehicle.car import car_numbers
from ev_core.vehicle.motor import driving_torque

_STRAIGHT = 1e-6  # [1/m], the least curvature of a bend
# [m/s]; the second one for a car with drives that do not overcome its drag
_FASTEST, _SLOWEST = 60.0, 1.0


@dataclass(frozen=True, slots=True)
class LimitParameters:
    """The friction ellipse that the driver counts on, and how far he goes.

    Its axes are shares of one friction coefficient.
    """

    scale: float = parameter(
        0.85,
        unit="1",
        low=0.05,
        high=2.0,
        about="of the speed profile, so its square is that of all accelerations",
    )
    friction: float = parameter(
        1.0, unit="1", low=0.01, high=3.0, about="friction coefficient that the profile is made for"
    )
    lateral: float = parameter(
        1.0, unit="1", low=0.01, high=1.5, about="share of it across the line"
    )
    braking: float = parameter(
        0.9, unit="1", low=0.01, high=1.5, about="share of it in braking, on all wheels"
    )
    driving: float = parameter(
        0.8,
        unit="1",
        low=0.01,
        high=1.5,
        about="share of it in driving, on the load of the driven wheels at rest",
    )


@dataclass(frozen=True, slots=True)
class Limits:
    """The friction ellipse of a car: its largest accelerations [m/s^2], without `scale`."""

    lateral: float
    braking: float
    driving: float


def limits(p: LimitParameters, vehicle: Vehicle) -> Limits:
    """The ellipse of a car.

    Driven wheels carry its weight as they do at rest, and the brakes work on all wheels.
    """
    front = vehicle.centre_of_mass_to_rear_axle / vehicle.wheelbase
    loads = {"front_left": 0.5 * front, "front_right": 0.5 * front}
    driven = sum(loads.get(wheel, 0.5 * (1.0 - front)) for wheel in vehicle.driven_wheels)
    grip = p.friction * GRAVITY
    return Limits(p.lateral * grip, p.braking * grip, max(p.driving * grip * driven, 1e-3))


class _Drives:
    """Longitudinal accelerations that drives and drag give a car by its speed [m/s], [m/s^2]."""

    def __init__(self, vehicle: Vehicle) -> None:
        self._vehicle, self._car = vehicle, car_numbers(vehicle)
        load, weight = vehicle.road_load, vehicle.mass * GRAVITY
        air = 0.5 * vehicle.air_density * vehicle.drag_coefficient * vehicle.frontal_area
        self._constant, self._linear = (
            vehicle.rolling_resistance * weight + load.constant,
            load.linear,
        )
        self._quadratic = air + load.quadratic + vehicle.rolling_resistance_growth * weight

    def drag(self, speed: float) -> float:
        """The deceleration by rolling and air."""
        return (
            self._constant + speed * (self._linear + speed * self._quadratic)
        ) / self._vehicle.mass

    def driving(self, speed: float) -> float:
        """Acceleration by motors or engine beyond the drag, without regard to tyres."""
        vehicle, car = self._vehicle, self._car
        force = 0.0
        # An engine counts with its peak power; below 1 m/s that would be an ever larger force.
        if vehicle.engine.peak_power > 0.0:
            return vehicle.engine.peak_power / (vehicle.mass * max(speed, 1.0)) - self.drag(speed)
        for driven, gear, motors in zip(car["driven"], car["gear"], car["motors"], strict=True):
            turns = gear * speed / vehicle.wheel_radius
            torque = (
                driven
                * motors
                * driving_torque(vehicle.motor, vehicle.motor.peak_torque, 1.0, turns)
            )
            force += torque * gear * vehicle.motor.gear_efficiency / vehicle.wheel_radius
        return force / vehicle.mass - self.drag(speed)


def speed_profile(
    ellipse: Limits, vehicle: Vehicle, curvature: Sequence[float], step: Sequence[float]
) -> tuple[float, ...]:
    """Squared speeds [m^2/s^2] at the points of a line (n,) that ends at rest.

    `curvature` at the points (n,) [1/m], `step` the lengths from each to the next one (n - 1,) [m].
    """
    drives, bends = _Drives(vehicle), [abs(each) for each in curvature]
    squares = [min(ellipse.lateral / max(bend, _STRAIGHT), _FASTEST * _FASTEST) for bend in bends]
    # The line ends at rest, which the pass of braking carries back.
    squares[-1] = 0.0
    ends = list(zip(pairwise(range(len(bends))), step, strict=True))
    for (here, there), length in ends:
        square, speed = squares[here], sqrt(squares[here])
        by_tyres = _on_ellipse(
            square, max(bends[here], bends[there]), length, ellipse.lateral, ellipse.driving
        )
        # Tyres give what is left on the ellipse, and the drag slows down besides; motors have it
        # deducted already.
        growth = min(
            by_tyres - square - 2.0 * length * drives.drag(speed),
            2.0 * length * drives.driving(speed),
        )
        squares[there] = min(squares[there], max(square + growth, _SLOWEST * _SLOWEST))
    # Braking counts without the drag, which would only help.
    for (here, there), length in reversed(ends):
        by_tyres = _on_ellipse(
            squares[there], max(bends[here], bends[there]), length, ellipse.lateral, ellipse.braking
        )
        squares[here] = min(squares[here], by_tyres)
    return tuple(squares)


def _on_ellipse(square: float, bend: float, length: float, lateral: float, along: float) -> float:
    """Squared speed u at the faster end of a step, with its accelerations on the ellipse.

    ((u - u_0)/(2 h a_x))^2 + (u k/a_y)^2 = 1, with the curvature k of the sharper end.
    """
    p, q = 1.0 / (4.0 * length * length * along * along), bend * bend / (lateral * lateral)
    left = p + q - p * q * square * square
    return max((p * square + sqrt(left)) / (p + q), square) if left > 0.0 else square
