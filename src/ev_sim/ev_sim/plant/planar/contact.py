"""The contact of a wheel with the road: velocities, secants of the friction curve, friction limits."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from ev_msgs_py.compiling.compilable import inlined
from ev_msgs_py.elementary import sqrt
from ev_msgs_py.vehicle.car import Car
from ev_sim.plant.planar.constants import BodyConstants
from ev_sim.plant.planar.memory import Step
from ev_sim.plant.planar.state import SLIP_X, SLIP_Y, VX, VY, YAW_RATE
from ev_sim.tyres.combined import SLIP_VECTOR, STILL, slip_vector, uncoupled, within, within_circle
from ev_sim.tyres.curve import largest

LATERAL_CURVES = ("same", "linear")
SAME, LINEAR = range(len(LATERAL_CURVES))


class Contact(NamedTuple):
    """Velocities at a wheel, in its frame [m/s]."""

    along: float  # of its centre
    speed: float  # of its centre, magnitude
    rim: float
    slip_x: float
    slip_y: float


@inlined
def contact(y: Sequence[float], car: Car, body: BodyConstants, step: Step, i: int, wheel_speed: float) -> Contact:
    """The velocities at wheel i, which turns with `wheel_speed` [rad/s]."""
    cosine, sine = step.cos_steer[i], step.sin_steer[i]
    ground_x = y[VX] - body.wheel_y[i] * y[YAW_RATE]
    ground_y = y[VY] + body.wheel_x[i] * y[YAW_RATE]
    along = ground_x * cosine + ground_y * sine
    across = ground_y * cosine - ground_x * sine
    rim = car.wheel_radius * wheel_speed
    return Contact(along, sqrt(along * along + across * across), rim, rim - along, -across)


@inlined
def transports(car: Car, at: Contact) -> tuple[float, float]:
    """Transport velocities [m/s] for both directions of a wheel: the larger of rim and ground speed.

    Slip velocity over it is 1 - V/(r w) in traction and (r w - V)/V in braking.
    """
    if car.tyre.combined == SLIP_VECTOR:
        transport = max(abs(at.rim), at.speed, STILL)
        return transport, transport
    return max(abs(at.rim), abs(at.along), STILL), max(at.speed, STILL)


@inlined
def secants(y: Sequence[float], car: Car, body: BodyConstants, step: Step, i: int) -> tuple[float, float]:
    """Friction per slip [1] for both directions of wheel i, at the slip of its contact."""
    tyre, on_road, slip_x, slip_y = car.tyre, step.tyre[i], y[SLIP_X + i], y[SLIP_Y + i]
    if tyre.combined == SLIP_VECTOR:
        return slip_vector(tyre, on_road, slip_x, slip_y)
    along_secant, across_secant = uncoupled(tyre, on_road, slip_x, slip_y)
    if tyre.lateral_curve == LINEAR:
        across_secant = body.cornering_stiffness[i]
    return along_secant, across_secant


@inlined
def limits(car: Car, step: Step, i: int, force_x: float, force_y: float) -> tuple[float, float]:
    """Factors [1] that keep the forces of wheel i [N] within its friction."""
    tyre, on_road = car.tyre, step.tyre[i]
    limit = step.load[i] * largest(tyre.curve, on_road.friction, on_road)
    if tyre.combined == SLIP_VECTOR:
        scale = within_circle(limit, force_x, force_y)
        return scale, scale
    return within(limit, force_x), 1.0 if tyre.lateral_curve == LINEAR else within(limit, force_y)
