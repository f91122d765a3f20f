"""Road and air: resistance of the body, contact velocities, secants of the friction curve, slips.

How it works: at each evaluation of the rates `look` finds the velocities of the four contacts and,
under the loads of the step, the secant of the friction curve along and across each wheel: the
force over the slip. `tyres.contact_patch` lets the carcass follow them. There are four
ways to combine slips: one curve over the slip vector, a curve for each direction, the Magic
Formula with its weights, and the normalized slips of TMeasy.
"""

from __future__ import annotations

from ev_core.law import GRAVITY, Car, asin, compilable, inlined, sqrt
from ev_sim.plant.planar import planar_state as state
from ev_sim.plant.planar.given import BodyConstants
from ev_sim.plant.planar.planar_state import Contacts, Row, Step
from ev_sim.plant.planar.prepare import RoadTables, Slope, Track
from ev_sim.profiles.profile import number_until
from ev_sim.surfaces import TyreOnRoad, interpolate, segment_at
from ev_sim.tyres import tmeasy
from ev_sim.tyres.contact_patch import (
    NORMALIZED,
    SLIP_VECTOR,
    STILL,
    WEIGHTED,
    normalized,
    sensitivity,
    slip_vector,
    uncoupled,
    weighted,
)
from ev_sim.tyres.curve import largest
from ev_sim.tyres.mf_tyre import MfTyre, at_load

_WIDTH = len(TyreOnRoad._fields)
LATERAL_CURVES = ("same", "linear", "constant_stiffness")
SAME_CURVE, LINEAR_CURVE, CONSTANT_STIFFNESS = range(len(LATERAL_CURVES))
INFINITE = 1e12  # [N], beyond any force, but a number that may be multiplied


@inlined
def speed_resistance(car: Car, body: BodyConstants, vx: float) -> float:
    """Resistance of the body [N] at a longitudinal velocity [m/s]: drag, or B V + C V^2."""
    return body.drag * abs(vx) * vx + car.road_load.linear * vx


@inlined
def find_road(y: Row, body: BodyConstants, step: Step, road: RoadTables, first: bool) -> None:
    """Set the tyre on the surface under each wheel, and gravity by the slope.

    Every wheel is looked up at its own travelled distance, ahead of or behind the centre of mass by
    its place in the car. The slope is that under the centre of mass. The `first` look-up of a
    period knows no segment to start from.
    """
    for axle in range(2):
        _look_under(y, body, step, road.left, 2 * axle, first)
        _look_under(y, body, step, road.right, 2 * axle + 1, first)
    before = 0 if first else int(step.slope_segment)
    gravity = gravity_at(road.slope, y[state.BODY_DISTANCE], before)
    step.gravity_x, step.gravity_y, step.gravity_z, segment = gravity
    step.slope_segment = float(segment)


@inlined
def gravity_at(slope: Slope, distance: float, before: int) -> tuple[float, float, float, int]:
    """Gravity in the frame of the road [m/s^2] at a travelled distance [m].

    Along the road, to the left, onto the road, and the segment of the slope, found from `before`.
    """
    rise, segment = interpolate(slope.distance, slope.grade, distance, before)
    # Both profiles have the same distances, so the segment is found already.
    side_rise, _ = interpolate(slope.distance, slope.side_slope, distance, segment)
    # The road is the plane z = rise x + side_rise y; its normal is (-rise, -side_rise, 1) over its
    # length.
    onto = GRAVITY / sqrt(1.0 + rise * rise + side_rise * side_rise)
    return -rise * onto, -side_rise * onto, onto, segment


@inlined
def _look_under(y: Row, body: BodyConstants, step: Step, track: Track, i: int, first: bool) -> None:
    """Set the tyre of wheel i from its track, where it has come to another segment."""
    distance = y[state.DISTANCE + i] + body.wheel_x[i]
    # A step before may have left the radius of a flat tyre here.
    if first:
        step.radius[i] = step.static_radius[i] = body.wheel_radius[i]
        found = max(number_until(track.start, distance) - 1, 0)
    else:
        before = int(step.segment[i])
        found = segment_at(track.start, distance, before)
        # Still on the same surface: the numbers are in the step.
        if found == before:
            return
    step.segment[i] = float(found)
    tyre, place = step.tyre[i], _WIDTH * found
    tyre.c0 = track.tyres[place]
    tyre.c1 = track.tyres[place + 1]
    tyre.c2 = track.tyres[place + 2]
    tyre.c3 = track.tyres[place + 3]
    tyre.rolling_resistance = track.tyres[place + 4]
    tyre.friction = track.tyres[place + 5]


@inlined
def look(y: Row, car: Car, body: BodyConstants, step: Step, starts: bool) -> None:
    """Find velocities and friction of all contacts, under the loads of the step.

    A wheel that the brake stops within the step stands, unless the evaluation `starts` it.
    """
    point(y, car, step)
    at = step.contact
    sideways = y[state.VY]
    if body.roll.rolls == 1.0:
        # The centre of mass sways over the axles as the body rolls.
        sideways += body.roll.lever * y[state.ROLL_RATE]
    for i in range(4):
        turning = y[state.WHEEL_SPEED + i]
        at.wheel_speed[i] = turning if starts or step.motion[i] * turning >= 0.0 else 0.0
    for i in range(4):
        # Velocity of the wheel centre in the frame of the body: v + yaw rate x place.
        ground_x = y[state.VX] - body.wheel_y[i] * y[state.YAW_RATE]
        ground_y = sideways + body.wheel_x[i] * y[state.YAW_RATE]
        along = ground_x * at.cosine[i] + ground_y * at.sine[i]
        across = ground_y * at.cosine[i] - ground_x * at.sine[i]
        at.along[i] = along
        at.speed[i] = sqrt(along * along + across * across)
        at.rim[i] = step.radius[i] * at.wheel_speed[i]
        # Positive as the force: a rim that is faster than the road drives, a wheel that goes to the
        # left is pushed to the right.
        at.slip_x[i] = at.rim[i] - along
        at.slip_y[i] = -across
    if car.tyre.combined == SLIP_VECTOR:
        for i in range(4):
            _one_curve(y, car, step, i)
    elif car.tyre.combined == WEIGHTED:
        _magic_formulas(y, body, step)
    elif car.tyre.combined == NORMALIZED:
        for i in range(4):
            _tmeasy(y, body, step, i)
    else:
        for i in range(4):
            _two_curves(y, car, body, step, i)


@inlined
def point(y: Row, car: Car, step: Step) -> None:
    """The directions of the wheels, as steered and as the side force on their axle bends them.

    The carcasses hold the side force, so it is taken from their deflection.
    """
    at, suspension = step.contact, car.suspension
    for i in range(4):
        at.cosine[i], at.sine[i] = step.cos_steer[i], step.sin_steer[i]
    if suspension.front_compliance_steer == 0.0 and suspension.rear_compliance_steer == 0.0:
        return
    for axle in range(2):
        # A side force to the left, as in a left bend, turns front wheels out of the bend, to the
        # right, and rear wheels into it, to the left.
        compliance = (
            suspension.rear_compliance_steer if axle else -suspension.front_compliance_steer
        )
        left = 2 * axle
        held = car.tyre.lateral_stiffness * (
            y[state.DEFLECTION_Y + left] + y[state.DEFLECTION_Y + left + 1]
        )
        t = compliance * held  # a small angle, and its tangent
        # Rotation of (cos, sin) by the small angle, kept at length 1.
        short = 1.0 / sqrt(1.0 + t * t)
        for i in range(left, left + 2):
            at.cosine[i] = (step.cos_steer[i] - step.sin_steer[i] * t) * short
            at.sine[i] = (step.sin_steer[i] + step.cos_steer[i] * t) * short


@inlined
def _one_curve(y: Row, car: Car, step: Step, i: int) -> None:
    """Set secants and largest forces of wheel i by one curve over its slip vector.

    The transport velocity is the larger of rim and ground speed, which gives 1 - V/(r w) in
    traction and (r w - V)/V in braking.
    """
    tyre = car.tyre
    on_road = step.tyre[i]
    at = step.contact
    transport = max(abs(at.rim[i]), at.speed[i], STILL)
    carried = step.load[i] * sensitivity(tyre, step.load[i])
    slid = (at.slip_x[i], at.slip_y[i])
    contact = (y[state.SLIP_X + i], y[state.SLIP_Y + i])
    along, across = slip_vector(tyre, on_road, slid, transport, contact)
    limit = carried * largest(tyre.curve, on_road.friction, on_road)
    at.secant_x[i] = carried * along
    at.secant_y[i] = carried * across
    at.transport_x[i] = at.transport_y[i] = transport
    at.largest_x[i] = at.largest_y[i] = limit


@compilable  # once in the code of a plant: it is long, and a call is nothing beside it
def _magic_formulas(y: Row, body: BodyConstants, step: Step) -> None:
    """Set secants and largest forces of all wheels by the Magic Formula."""
    at = step.contact
    for i in range(4):
        at.grip[i], at.stiffness[i] = step.tyre[i].c0, step.tyre[i].c1
    # The compiler unrolls a loop of known length, and then does not work out four wheels at
    # once.
    wheels = int(body.number_of_wheels)
    if body.mf_is_plain == 1.0:
        for i in range(wheels):
            _magic_formula(y, step, MfTyre(body.mf, i, True))
    else:
        for i in range(wheels):
            _magic_formula(y, step, MfTyre(body.mf, i, False))


@inlined
def _magic_formula(y: Row, step: Step, tyre: MfTyre) -> None:
    at, i = step.contact, tyre.i
    transport = max(abs(at.rim[i]), at.speed[i], STILL)
    loaded = at_load(tyre, step.load[i], at.grip[i], at.stiffness[i])
    slip = (at.slip_x[i], at.slip_y[i])
    contact = (y[state.SLIP_X + i], y[state.SLIP_Y + i])
    secants = weighted(tyre, loaded, slip, at.along[i], transport, contact)
    at.secant_x[i], at.secant_y[i] = secants
    at.transport_x[i] = at.transport_y[i] = transport
    at.largest_x[i], at.largest_y[i] = loaded.peak_x, loaded.peak_y


@compilable  # as `_magic_formulas`
def _tmeasy(y: Row, body: BodyConstants, step: Step, i: int) -> None:
    """Set secants and largest forces of wheel i by TMeasy."""
    at = step.contact
    load = step.load[i]
    transport = max(abs(at.rim[i]), at.speed[i], STILL)
    of = tmeasy.at_load(body.tmeasy[i], load, step.tyre[i].c0, step.tyre[i].c1)
    slid = (at.slip_x[i], at.slip_y[i])
    contact = (y[state.SLIP_X + i], y[state.SLIP_Y + i])
    along, across = normalized(of, slid, at.rim[i], transport, contact)
    at.secant_x[i], at.secant_y[i] = load * along, load * across
    at.transport_x[i] = at.transport_y[i] = transport
    at.largest_x[i], at.largest_y[i] = load * of.along.peak, load * of.across.peak


@inlined
def _two_curves(y: Row, car: Car, body: BodyConstants, step: Step, i: int) -> None:
    """Set secants and largest forces of wheel i by a curve for each direction.

    A lateral line has no largest force.
    """
    tyre = car.tyre
    on_road = step.tyre[i]
    at = step.contact
    carried = step.load[i] * sensitivity(tyre, step.load[i])
    transport_x = max(abs(at.rim[i]), abs(at.along[i]), STILL)
    # Across, slip is over the speed of the wheel centre alone: the sine of the slip angle, however
    # fast the wheel turns.
    transport_y = max(at.speed[i], STILL)
    slid = (at.slip_x[i], at.slip_y[i])
    contact = (y[state.SLIP_X + i], y[state.SLIP_Y + i])
    along, across = uncoupled(tyre, on_road, slid, (transport_x, transport_y), contact)
    limit = carried * largest(tyre.curve, on_road.friction, on_road)
    at.transport_x[i], at.transport_y[i] = transport_x, transport_y
    at.largest_x[i] = limit
    # A line has no peak, so nothing scales its force down.
    at.largest_y[i] = limit if tyre.lateral_curve == SAME_CURVE else INFINITE
    at.secant_x[i], at.secant_y[i] = carried * along, carried * across
    if tyre.lateral_curve == LINEAR_CURVE:
        at.secant_y[i] = carried * body.cornering_stiffness[i]
    elif tyre.lateral_curve == CONSTANT_STIFFNESS:
        # Over the slip angle itself, while slips are sines of it.
        # Rounding may put the sine above 1.
        sine = min(abs(at.slip_y[i]) / transport_y, 1.0)
        at.secant_y[i] = body.cornering_stiffness[i] * (asin(sine) / sine if sine > 0.0 else 1.0)


@inlined
def within_friction(
    car: Car, at: Contacts, i: int, force_x: float, force_y: float
) -> tuple[float, float]:
    """Factors [1] that keep forces along and across wheel i [N] within its friction.

    They are one for both on a circle.
    """
    if car.tyre.combined == SLIP_VECTOR:
        # The square root is only taken beyond the circle, which is seldom.
        squared = force_x * force_x + force_y * force_y
        limit = at.largest_x[i]
        scale = limit / sqrt(squared) if squared > limit * limit else 1.0
        return scale, scale
    return _within(force_x, at.largest_x[i]), _within(force_y, at.largest_y[i])


@inlined
def _within(force: float, largest: float) -> float:
    """Factor [1] that keeps one force [N] within the largest one."""
    return largest / abs(force) if abs(force) > largest else 1.0


@inlined
def slips(y: Row, car: Car, body: BodyConstants, at: Contacts, i: int) -> tuple[float, float]:
    """Slips [1] at which the friction curve gives the present forces of wheel i, along and across.

    In steady driving they are the slip ratio and the sine of the slip angle (with the sign of their
    force); at rest, where kinematic slip is 0/0, they stay meaningful and continuous.
    """
    # The balance of carcass and contact of `force_and_rate`, solved for the slip in place of the
    # force.
    spring_x = (
        car.tyre.longitudinal_stiffness * y[state.DEFLECTION_X + i] + body.damping_x * at.slip_x[i]
    )
    spring_y = (
        car.tyre.lateral_stiffness * y[state.DEFLECTION_Y + i] + body.damping_y * at.slip_y[i]
    )
    slip_x = spring_x / (at.secant_x[i] + at.transport_x[i] * body.damping_x)
    slip_y = spring_y / (at.secant_y[i] + at.transport_y[i] * body.damping_y)
    scale_x, scale_y = within_friction(car, at, i, at.secant_x[i] * slip_x, at.secant_y[i] * slip_y)
    return slip_x * scale_x, slip_y * scale_y
