"""The contact of a wheel with the road: slip velocities, secants of the friction curve, slips that are shown."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

from ev_msgs_py.compiling.compilable import inlined
from ev_msgs_py.elementary import asin, sqrt
from ev_msgs_py.vehicle.car import Car
from ev_sim.plant.planar.constants import BodyConstants
from ev_sim.plant.planar.memory import Step
from ev_sim.plant.planar.state import DEFLECTION_X, DEFLECTION_Y, SLIP_X, SLIP_Y, VX, VY, WHEEL_SPEED, YAW_RATE
from ev_sim.tyres.combined import SLIP_VECTOR, STILL, slip_vector, uncoupled
from ev_sim.tyres.curve import largest

LATERAL_CURVES = ("same", "linear", "constant_stiffness")
SAME, LINEAR, CONSTANT_STIFFNESS = range(len(LATERAL_CURVES))
INFINITE = 1e12  # [N], beyond any force, but a number that may be multiplied


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
    rim = step.radius[i] * wheel_speed
    return Contact(along, sqrt(along * along + across * across), rim, rim - along, -across)


@inlined
def secants(
    y: Sequence[float], car: Car, body: BodyConstants, step: Step, i: int, at: Contact
) -> tuple[float, float, float, float]:
    """Force per slip [N] and transport velocity [m/s], for both directions of wheel i.

    The transport velocity is the larger of rim and ground speed, which gives 1 - V/(r w) in traction and (r w - V)/V in
    braking.
    """
    tyre, on_road, load = car.tyre, step.tyre[i], step.load[i]
    slid_x, slid_y = y[SLIP_X + i], y[SLIP_Y + i]
    if tyre.combined == SLIP_VECTOR:
        transport = max(abs(at.rim), at.speed, STILL)
        along_secant, across_secant = slip_vector(tyre, on_road, at.slip_x, at.slip_y, transport, slid_x, slid_y)
        return load * along_secant, load * across_secant, transport, transport
    transport_x = max(abs(at.rim), abs(at.along), STILL)
    transport_y = max(at.speed, STILL)
    along_secant, across_secant = uncoupled(
        tyre, on_road, at.slip_x, at.slip_y, transport_x, transport_y, slid_x, slid_y
    )
    across = load * across_secant
    if tyre.lateral_curve == LINEAR:
        across = load * body.cornering_stiffness[i]
    elif tyre.lateral_curve == CONSTANT_STIFFNESS:
        # Over the slip angle itself, while slips are sines of it.
        sine = min(abs(at.slip_y) / transport_y, 1.0)
        across = body.cornering_stiffness[i] * (asin(sine) / sine if sine > 0.0 else 1.0)
    return load * along_secant, across, transport_x, transport_y


@inlined
def friction_limits(car: Car, step: Step, i: int) -> tuple[float, float]:
    """The largest forces that the friction of wheel i has along and across [N]; a lateral line has no such limit."""
    tyre, on_road = car.tyre, step.tyre[i]
    limit = step.load[i] * largest(tyre.curve, on_road.friction, on_road)
    return limit, limit if tyre.lateral_curve == SAME else INFINITE


@inlined
def within_friction(car: Car, step: Step, i: int, force_x: float, force_y: float) -> tuple[float, float]:
    """Factors [1] that keep forces along and across wheel i [N] within its friction, one for both on a circle."""
    limit_x, limit_y = friction_limits(car, step, i)
    if car.tyre.combined == SLIP_VECTOR:
        squared = force_x * force_x + force_y * force_y
        scale = limit_x / sqrt(squared) if squared > limit_x * limit_x else 1.0
        return scale, scale
    return (
        limit_x / abs(force_x) if abs(force_x) > limit_x else 1.0,
        limit_y / abs(force_y) if abs(force_y) > limit_y else 1.0,
    )


@inlined
def slips(y: Sequence[float], car: Car, body: BodyConstants, step: Step, i: int) -> tuple[float, float]:
    """The slips [1] at which the friction curve gives the present forces of wheel i, along and across.

    In steady driving they are the slip ratio and the sine of the slip angle (with the sign of their force); at rest,
    where kinematic slip is 0/0, they stay meaningful and continuous.
    """
    at = contact(y, car, body, step, i, y[WHEEL_SPEED + i])
    secant_x, secant_y, transport_x, transport_y = secants(y, car, body, step, i, at)
    spring_x = car.tyre.longitudinal_stiffness * y[DEFLECTION_X + i] + body.damping_x * at.slip_x
    spring_y = car.tyre.lateral_stiffness * y[DEFLECTION_Y + i] + body.damping_y * at.slip_y
    slip_x = spring_x / (secant_x + transport_x * body.damping_x)
    slip_y = spring_y / (secant_y + transport_y * body.damping_y)
    scale_x, scale_y = within_friction(car, step, i, secant_x * slip_x, secant_y * slip_y)
    return slip_x * scale_x, slip_y * scale_y
