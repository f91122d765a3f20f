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
from ev_sim.tyres.combined import SLIP_VECTOR, STILL, UNCOUPLED, slip_vector, uncoupled
from ev_sim.tyres.curve import largest
from ev_sim.tyres.degressive import sensitivity
from ev_sim.tyres.weighted import weighted

LATERAL_CURVES = ("same", "linear", "constant_stiffness")
SAME, LINEAR, CONSTANT_STIFFNESS = range(len(LATERAL_CURVES))
INFINITE = 1e12  # [N], beyond any force, but a number that may be multiplied


class Friction(NamedTuple):
    """What friction gives at a wheel, along it and across."""

    secant_x: float  # force over slip [N]
    secant_y: float
    transport_x: float  # transport velocity, over which slip velocities are slips [m/s]
    transport_y: float
    largest_x: float  # force that the road holds [N]
    largest_y: float


class Contact(NamedTuple):
    """Direction of a wheel, and velocities in its frame [m/s]."""

    cosine: float  # of its angle against the body
    sine: float
    along: float  # of its centre
    speed: float  # of its centre, magnitude
    rim: float
    slip_x: float
    slip_y: float


@inlined
def contact(y: Sequence[float], car: Car, body: BodyConstants, step: Step, i: int, wheel_speed: float) -> Contact:
    """The velocities at wheel i, which turns with `wheel_speed` [rad/s]."""
    cosine, sine = direction(y, car, step, i)
    ground_x = y[VX] - body.wheel_y[i] * y[YAW_RATE]
    ground_y = y[VY] + body.wheel_x[i] * y[YAW_RATE]
    along = ground_x * cosine + ground_y * sine
    across = ground_y * cosine - ground_x * sine
    rim = step.radius[i] * wheel_speed
    return Contact(cosine, sine, along, sqrt(along * along + across * across), rim, rim - along, -across)


@inlined
def direction(y: Sequence[float], car: Car, step: Step, i: int) -> tuple[float, float]:
    """Cosine and sine of the angle of wheel i, as steered and as the side force on its axle bends it.

    The carcasses hold the side force, so it is taken from their deflection.
    """
    cosine, sine = step.cos_steer[i], step.sin_steer[i]
    compliance = -car.suspension.front_compliance_steer if i < 2 else car.suspension.rear_compliance_steer
    if compliance == 0.0:
        return cosine, sine
    left = DEFLECTION_Y if i < 2 else DEFLECTION_Y + 2
    t = compliance * car.tyre.lateral_stiffness * (y[left] + y[left + 1])  # a small angle, and its tangent
    length = sqrt(1.0 + t * t)
    return (cosine - sine * t) / length, (sine + cosine * t) / length


@inlined
def friction(y: Sequence[float], car: Car, body: BodyConstants, step: Step, i: int, at: Contact) -> Friction:
    """The friction of wheel i.

    The transport velocity is the larger of rim and ground speed, which gives 1 - V/(r w) in traction and (r w - V)/V in
    braking. A lateral line knows no largest force.
    """
    tyre, on_road, load = car.tyre, step.tyre[i], step.load[i]
    slid_x, slid_y = y[SLIP_X + i], y[SLIP_Y + i]
    transport = max(abs(at.rim), at.speed, STILL)
    if tyre.combined == SLIP_VECTOR:
        carried = load * sensitivity(tyre, load)
        along_secant, across_secant = slip_vector(tyre, on_road, at.slip_x, at.slip_y, transport, slid_x, slid_y)
        limit = carried * largest(tyre.curve, on_road.friction, on_road)
        return Friction(carried * along_secant, carried * across_secant, transport, transport, limit, limit)
    if tyre.combined != UNCOUPLED:
        forces = weighted(body.mf[i], on_road, load, at.slip_x, at.slip_y, at.along, transport, slid_x, slid_y)
        return Friction(forces[0], forces[1], transport, transport, forces[2], forces[3])
    carried = load * sensitivity(tyre, load)
    transport_x = max(abs(at.rim), abs(at.along), STILL)
    transport_y = max(at.speed, STILL)
    along_secant, across_secant = uncoupled(
        tyre, on_road, at.slip_x, at.slip_y, transport_x, transport_y, slid_x, slid_y
    )
    limit_x = carried * largest(tyre.curve, on_road.friction, on_road)
    limit_y = limit_x if tyre.lateral_curve == SAME else INFINITE
    across = carried * across_secant
    if tyre.lateral_curve == LINEAR:
        across = carried * body.cornering_stiffness[i]
    elif tyre.lateral_curve == CONSTANT_STIFFNESS:
        # Over the slip angle itself, while slips are sines of it.
        sine = min(abs(at.slip_y) / transport_y, 1.0)
        across = body.cornering_stiffness[i] * (asin(sine) / sine if sine > 0.0 else 1.0)
    return Friction(carried * along_secant, across, transport_x, transport_y, limit_x, limit_y)


@inlined
def within_friction(car: Car, of: Friction, force_x: float, force_y: float) -> tuple[float, float]:
    """Factors [1] that keep forces along and across a wheel [N] within its friction, one for both on a circle."""
    if car.tyre.combined == SLIP_VECTOR:
        squared = force_x * force_x + force_y * force_y
        scale = of.largest_x / sqrt(squared) if squared > of.largest_x * of.largest_x else 1.0
        return scale, scale
    return (
        of.largest_x / abs(force_x) if abs(force_x) > of.largest_x else 1.0,
        of.largest_y / abs(force_y) if abs(force_y) > of.largest_y else 1.0,
    )


@inlined
def slips(y: Sequence[float], car: Car, body: BodyConstants, step: Step, i: int) -> tuple[float, float]:
    """The slips [1] at which the friction curve gives the present forces of wheel i, along and across.

    In steady driving they are the slip ratio and the sine of the slip angle (with the sign of their force); at rest,
    where kinematic slip is 0/0, they stay meaningful and continuous.
    """
    at = contact(y, car, body, step, i, y[WHEEL_SPEED + i])
    of = friction(y, car, body, step, i, at)
    spring_x = car.tyre.longitudinal_stiffness * y[DEFLECTION_X + i] + body.damping_x * at.slip_x
    spring_y = car.tyre.lateral_stiffness * y[DEFLECTION_Y + i] + body.damping_y * at.slip_y
    slip_x = spring_x / (of.secant_x + of.transport_x * body.damping_x)
    slip_y = spring_y / (of.secant_y + of.transport_y * body.damping_y)
    scale_x, scale_y = within_friction(car, of, of.secant_x * slip_x, of.secant_y * slip_y)
    return slip_x * scale_x, slip_y * scale_y
