"""Gains of a driver that knows the car: optimal preview control of the single-track model.

How it works: for each of some speeds the linear car beside a straight path is put into steps of
POINT_STEP, and the Riccati equation gives the feedback of its state. The same matrices give the
gain of each turn of the path ahead, because a bend is a disturbance that is known before.

Sharp and Valtetsiotis (2001), Optimal preview car steering control, Vehicle System Dynamics
Supplement 35, 101-117; Peng and Tomizuka (1993), Preview control for vehicle lateral guidance in
highway automation, J. Dyn. Syst. Meas. Control 115.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import NamedTuple

import numpy as np

from ev_core.law import Vehicle, parameter
from ev_sim.understeer import axle_cornering_stiffnesses

POINT_STEP = 0.05  # [s] from one point of the path that the driver looks at to the next
STATES = (
    "lateral_velocity",
    "yaw_rate",
    "heading_error",
    "lateral_error",
    "wheels",
    "arms",
    "intended",
)
ASIDE, TURNING, HEADING_ERROR, LATERAL_ERROR, ROAD_WHEELS, ARMS, INTENDED = range(len(STATES))
# The speeds [m/s] between which gains are interpolated. Below the first the driver looks as far as
# at it, for at rest there would be nothing ahead.
GAIN_SPEEDS = (4.0, 5.0, 6.0, 8.0, 10.0, 13.0, 16.0, 20.0, 25.0, 30.0, 36.0, 43.0, 51.0, 60.0)
_HORIZON = 200  # steps of the sum that is least: 10 s, after which the gains no longer change
# Halvings of POINT_STEP before the exponential series, which then is exact to rounding, and its
# terms.
_HALVINGS = 6
_SERIES = 12


@dataclass(frozen=True, slots=True)
class PreviewParameters:
    """Reach, quickness and aims of the driver."""

    preview_time: float = parameter(
        2.0,
        unit="s",
        low=0.1,
        high=5.0,
        about="how far ahead the driver sees the path; rounded to points of 0.05 s",
        source="assumption; beyond 1 to 1.5 s it changes nothing (Sharp & Valtetsiotis 2001)",
    )
    lag: float = parameter(
        0.1,
        unit="s",
        low=0.02,
        high=1.0,
        about="first-order lag of the arms behind the intended angle, known to him",
        source="assumption; 0.1 to 0.2 s are usual for drivers",
    )
    column_lag: float = parameter(
        0.04,
        unit="s",
        low=0.005,
        high=1.0,
        about="first-order lag of the tyres' side forces behind the arms, known to him: hands and "
        "column, a period of "
        "the control, and the tyres' relaxation",
        source="0.017 s of the default hands on the column of Shchur 2019, 0.01 s, and 0.016 s at "
        "80 km/h",
    )
    lateral_error: float = parameter(
        0.1,
        unit="m",
        low=0.001,
        high=10.0,
        about="distance from the path that he minds as much as `steering_rate`",
    )
    lateral_rate: float = parameter(
        0.1,
        unit="m/s",
        low=0.001,
        high=100.0,
        about="speed away from the path that he minds as much",
    )
    steering_rate: float = parameter(
        0.1,
        unit="rad/s",
        low=0.001,
        high=10.0,
        about="rate of the intended road-wheel angle that he minds as much",
    )
    learning: float = parameter(
        6.0,
        unit="1",
        low=1.0,
        high=1e6,
        about="time in which he learns by how much angle and sideslip in a bend differ from those "
        "of the linear car, "
        "over that in which they settle: `lag`, `column_lag` and m V/(C_1 + C_2); 1e6 for never",
    )
    learnt_angle: float = parameter(
        0.1, unit="rad", low=0.0, high=1.4, about="that he learns at most of each, either way"
    )
    max_angle: float = parameter(
        0.6, unit="rad", low=0.01, high=1.4, about="largest road-wheel angle, either way"
    )


class PreviewGains(NamedTuple):
    """Rate of the intended angle [rad/s] per state (STATES) and per turn [rad] of the path ahead.

    One row behind the other, forwards by GAIN_SPEEDS and then backwards; `points` ahead.
    """

    feedback: tuple[float, ...]
    preview: tuple[float, ...]
    points: float


@lru_cache(1024)  # cars: each law and search of a board has the same draws again
def preview_gains(p: PreviewParameters, vehicle: Vehicle) -> PreviewGains:
    """Gains that make the sum of (y/lateral_error)^2 + (rate/steering_rate)^2 least on any path.

    With P of the Riccati equation, K = (r + B'PB)^-1 B'PA and A_c = A - B K, a turn of the path i
    steps ahead has the gain (r + B'PB)^-1 B' (A_c')^(i-1) P e, e the heading error: the optimum for
    a disturbance that is known before. Behind the last point the path is taken to bend on as there,
    so that a circle is followed without error however short the preview is.
    """
    # Without a point ahead the driver would see no bend at all.
    points = max(round(p.preview_time / POINT_STEP), 1)
    speed = np.array([*GAIN_SPEEDS, *(-speed for speed in GAIN_SPEEDS)])
    a, b = _stepped(*_model(p, vehicle, speed))
    weight = np.zeros_like(a)
    weight[:, LATERAL_ERROR, LATERAL_ERROR] = 1.0 / (p.lateral_error * p.lateral_error)
    minded = 1.0 / (p.lateral_rate * p.lateral_rate)
    # (v + V psi)^2, the squared speed away from the path, written out.
    weight[:, ASIDE, ASIDE] = minded
    weight[:, ASIDE, HEADING_ERROR] = weight[:, HEADING_ERROR, ASIDE] = minded * speed
    weight[:, HEADING_ERROR, HEADING_ERROR] = minded * speed * speed
    effort = 1.0 / (p.steering_rate * p.steering_rate)
    a_turned, b_turned = a.swapaxes(1, 2), b.swapaxes(1, 2)
    # Riccati recursion from the end of the horizon back to now.
    cost = weight
    for _ in range(_HORIZON):
        by_steering = _product(b_turned, cost)
        share = effort + _product(by_steering, b)
        feedback = _product(by_steering, a) / share
        cost = weight + _product(_product(a_turned, cost), a - _product(b, feedback))
        # Rounding would let the two halves of the symmetric matrix drift apart.
        cost = 0.5 * (cost + cost.swapaxes(1, 2))
    # A turn of the path ahead acts as a step of the heading error when the car gets there.
    kept = (a - _product(b, feedback)).swapaxes(1, 2)
    ahead, preview = cost[:, :, HEADING_ERROR, None], []
    for _ in range(points + _HORIZON):
        preview.append((_product(b_turned, ahead) / share)[:, 0, 0])
        ahead = _product(kept, ahead)
    # The last point also stands for the same turn at all points behind it.
    preview[points - 1 :] = [sum(preview[points - 1 :])]
    return PreviewGains(_flat(feedback), _flat(np.array(preview).T), float(points))


def _model(
    p: PreviewParameters, vehicle: Vehicle, speed: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Matrices of x' = A x + B u beside a straight path: (n, 7, 7) and (n, 7, 1).

    The speeds [m/s] are negative in reverse. x is STATES, u the rate of the intended road-wheel
    angle [rad/s]; angles are small.
    """
    rear = vehicle.centre_of_mass_to_rear_axle
    ahead, back = (axle_cornering_stiffnesses(vehicle, ahead=way) for way in (1.0, -1.0))
    stiffnesses = (np.where(speed > 0.0, *of_axle) for of_axle in zip(ahead, back, strict=True))
    # Distance of each axle ahead of the centre of mass, with its stiffness for this direction.
    axles = zip((vehicle.wheelbase - rear, -rear), stiffnesses, strict=True)
    a, b = np.zeros((len(speed), len(STATES), len(STATES))), np.zeros((len(speed), len(STATES), 1))
    for (place, stiffness), steered in zip(axles, (1.0, vehicle.rear_steering_ratio), strict=True):
        for state, inertia in ((ASIDE, vehicle.mass), (TURNING, vehicle.yaw_inertia / place)):
            # F = C (delta V - v - r x)/|V|: side force by the slip angle of the axle, either way of
            # driving.
            force = stiffness / inertia / np.abs(speed)
            a[:, state, ASIDE] -= force
            a[:, state, TURNING] -= force * place
            a[:, state, ROAD_WHEELS] += force * speed * steered
    a[:, ASIDE, TURNING] -= speed
    a[:, HEADING_ERROR, TURNING] = 1.0
    a[:, LATERAL_ERROR, ASIDE] = 1.0
    a[:, LATERAL_ERROR, HEADING_ERROR] = speed
    for state, before, lag in ((ROAD_WHEELS, ARMS, p.column_lag), (ARMS, INTENDED, p.lag)):
        a[:, state, before] = 1.0 / lag
        a[:, state, state] = -1.0 / lag
    b[:, INTENDED, 0] = 1.0
    return a, b


def _stepped(a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A and B of x(t + STEP) = A x(t) + B u."""
    size = a.shape[1]
    both = np.zeros((len(a), size + 1, size + 1))
    both[:, :size, :size], both[:, :size, size:] = a, b
    # exp of the block matrix ((A, B), (0, 0)) holds both results; scaled down, by a series, and
    # squared as often as it was halved.
    both *= math.ldexp(POINT_STEP, -_HALVINGS)
    found = term = np.zeros_like(both) + np.eye(size + 1)
    for n in range(1, _SERIES):
        term = _product(term, both) / n
        found = found + term
    for _ in range(_HALVINGS):
        found = _product(found, found)
    return found[:, :size, :size], found[:, :size, size:]


def _product(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Product of matrices (n, i, k) and (n, k, j), summed in one order.

    A BLAS adds up by processor, and bits would differ.
    """
    total = a[:, :, 0, None] * b[:, 0, None, :]
    for k in range(1, a.shape[2]):
        total = total + a[:, :, k, None] * b[:, k, None, :]
    return total


def _flat(rows: np.ndarray) -> tuple[float, ...]:
    return tuple(float(value) for value in rows.ravel())
