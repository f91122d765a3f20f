"""Newton-Euler for the body in the plane and its four wheels, with loads and steering angles.

Frame: x forward, y left, z up, at the centre of mass. Equations: dissertation, eqs 2.20-2.26, and
Ge & Ni 2005, with the signs of one right-handed frame.

How it works: `rates` is the right-hand side f(y) of one system of differential equations: body,
loads, wheels, carcasses, contacts, roll, and the works of all forces. `integrate` takes one step of
the classical Runge-Kutta method. Dry friction is set-valued at rest, so the first evaluation of a
step decides which direction it opposes at each wheel, and the other three keep to it. All sums go
over left and right first: a mirrored state has exactly mirrored rates.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from ev_core.compiled.loop import compiled, one_record
from ev_core.law import NO_WHEELS, Car, Vehicle, Wheels, copysign, cos, inlined, sin, sqrt, tan
from ev_core.parameters.declaration import number_tree
from ev_core.vehicle.car import car_numbers, front_wheel_tangents
from ev_sim.plant.planar import planar_state as state
from ev_sim.plant.planar.contact import find_road, look, speed_resistance, within_friction
from ev_sim.plant.planar.given import (
    SPEED_FREE,
    BodyConstants,
    PlanarParameters,
    RollConstants,
    body_constants,
)
from ev_sim.plant.planar.model import Mechanics
from ev_sim.plant.planar.planar_state import INTEGRATED_SIZE, WHEEL_SPEED, Row, Step
from ev_sim.plant.planar.prepare import road_tables
from ev_sim.tyres.contact_patch import force_and_rate, slip_rate


@inlined
def steer(car: Car, step: Step, angle: float, apart: float) -> None:
    """Set the direction of the wheels from the mean road-wheel angle of the front ones [rad].

    Both rear wheels follow it by the vehicle's `rear_steering_ratio`, 0 for straight ones, and an
    actuator of their own may turn them `apart` from that [rad]. Source: Ge & Ni 2005, eq 3.
    """
    cos_left, sin_left, cos_right, sin_right = front_wheels(car, angle)
    step.cos_steer[0], step.sin_steer[0] = cos_left, sin_left
    step.cos_steer[1], step.sin_steer[1] = cos_right, sin_right
    rear = car.rear_steering_ratio * angle + apart
    step.cos_steer[2] = step.cos_steer[3] = cos(rear) if rear != 0.0 else 1.0
    step.sin_steer[2] = step.sin_steer[3] = sin(rear)


@inlined
def front_wheels(car: Car, angle: float) -> tuple[float, float, float, float]:
    """Cosine and sine of the angle of the left, then of the right front wheel.

    `angle` is the mean of both [rad].
    """
    left, right = front_wheel_tangents(
        tan(angle), car.wheelbase, car.front_track, car.steering_geometry
    )
    # cos = 1/sqrt(1 + tan^2) and sin = tan cos: no arc tangent, and always a direction of length 1.
    cos_left = 1.0 / sqrt(1.0 + left * left)
    cos_right = 1.0 / sqrt(1.0 + right * right)
    return cos_left, left * cos_left, cos_right, right * cos_right


@inlined
def loads(y: Row, car: Car, body: BodyConstants, gravity_z: float) -> Wheels:
    """Loads of the four wheels [N] under gravity that presses the car on the road [m/s^2]."""
    # The transfer is a state that lags behind the tyre forces: forces depend on loads, and loads on
    # the forces of the same instant would be an equation to solve in each evaluation.
    pitch_moment = car.pitch_height * car.mass * y[state.TRANSFER_X]
    return wheel_loads(car, car.mass * gravity_z, pitch_moment, roll_moments(y, car, body.roll))


@inlined
def roll_moments(y: Row, car: Car, roll: RollConstants) -> tuple[float, float]:
    """Roll moments that front and rear axle take [N m]; they unload the left wheels."""
    sideways = y[state.TRANSFER_Y]
    if roll.rolls == 0.0:
        moment = car.roll_height * car.mass * sideways
        return car.front_roll_share * moment, (1.0 - car.front_roll_share) * moment
    # Links take the side force at the roll centres, springs and dampers what leans the body.
    angle, rate = y[state.ROLL_ANGLE], y[state.ROLL_RATE]
    front = roll.front_stiffness * angle + roll.front_damping * rate
    rear = roll.rear_stiffness * angle + roll.rear_damping * rate
    return roll.front_link * sideways + front, roll.rear_link * sideways + rear


@inlined
def wheel_loads(
    car: Car, normal: float, pitch_moment: float, roll_moment: tuple[float, float]
) -> Wheels:
    """Loads of the four wheels [N]; their sum is always `normal`, none is below zero.

    `normal` [N] presses the car on the road; `pitch_moment` and those of front and rear axle in
    `roll_moment` [N m] are moments that unload the front axle and the left wheels. The part of the
    roll moment that an axle cannot take, because a wheel has lifted, goes to the other axle (rigid
    frame). Source: Ge & Ni 2005, loads N_1..N_4; dissertation, eqs 2.28-2.31.
    """
    offset = car.centre_of_mass_offset
    front_moment, rear_moment = roll_moment
    front = (normal * car.centre_of_mass_to_rear_axle - pitch_moment) / car.wheelbase
    # A moment that lifts a whole axle leaves all the weight on the other one.
    front = min(max(front, 0.0), normal)
    rear = normal - front
    # The moment that an axle takes before a wheel lifts.
    front_limit = 0.5 * front * car.front_track
    rear_limit = 0.5 * rear * car.rear_track
    front_wanted = front_moment - front * offset
    rear_wanted = rear_moment - rear * offset
    # What an axle is asked for beyond its limit goes to the other one below.
    front_excess = front_wanted - min(max(front_wanted, -front_limit), front_limit)
    rear_excess = rear_wanted - min(max(rear_wanted, -rear_limit), rear_limit)
    # Where both wheels of a side have lifted, the rest of the moment is lost: this car cannot roll
    # over.
    front_taken = min(max(front_wanted + rear_excess, -front_limit), front_limit)
    rear_taken = min(max(rear_wanted + front_excess, -rear_limit), rear_limit)
    # As shares of the limits, so that the load of a lifted wheel is exactly zero.
    front_share = front_taken / front_limit if front_limit > 0.0 else 0.0
    rear_share = rear_taken / rear_limit if rear_limit > 0.0 else 0.0
    return Wheels(
        0.5 * front * (1.0 - front_share),
        0.5 * front * (1.0 + front_share),
        0.5 * rear * (1.0 - rear_share),
        0.5 * rear * (1.0 + rear_share),
    )


@inlined
def bear(y: Row, car: Car, body: BodyConstants, step: Step) -> None:
    """Set the loads of the wheels, and the rolling radii under them."""
    load = step.load
    load[0], load[1], load[2], load[3] = loads(y, car, body, step.gravity_z)
    if car.tyre.radius_over_load > 0.0:
        for i in range(4):
            above = load[i] - body.static_load[i]
            step.radius[i] = step.static_radius[i] - car.tyre.radius_over_load * above


class OfWheel(NamedTuple):
    """Force of a wheel, or of all, on the body, in its frame, the moment, and powers."""

    x: float  # [N]
    y: float  # [N]
    moment: float  # about the centre of mass [N m]
    tyre_power: float  # taken by the tyre, in slip and carcass, or given to it by the rim [W]
    friction_power: float  # taken by brake and rolling resistance [W]


@inlined
def rates(y: Row, dy: Row, mechanics: Mechanics, starts: bool) -> None:
    """Set `dy` to the time derivative of the integrated part `y` of the state.

    Forces and slips go into the step. An evaluation that `starts` a step decides which direction
    dry friction opposes during it: that of the wheel's rotation, for a resting wheel that of the
    torque if it exceeds the friction, else the wheel is held.
    """
    _, car, body, step = mechanics
    vx = y[state.VX]
    bear(y, car, body, step)
    # Behind the loads, because the friction of the contacts is over them.
    look(y, car, body, step, starts)
    rolling = car.constant_rolling_resistance + car.rolling_resistance_growth * vx * vx
    wheels = of_all_wheels(_turn_wheel, y, dy, mechanics, (rolling, starts))
    dy[state.TYRE_WORK] = wheels.tyre_power
    dy[state.FRICTION_WORK] = wheels.friction_power
    _move_body(y, dy, mechanics, wheels.x / car.mass, wheels.y / car.mass)
    dy[state.YAW_RATE] = wheels.moment / car.yaw_inertia
    _roll_body(y, dy, mechanics, wheels.y / car.mass)


@inlined
def of_all_wheels(
    turn: Callable[..., OfWheel], y: Row, dy: Row, mechanics: Mechanics, by: tuple[float, float]
) -> OfWheel:
    """Sum of what `turn` gives of each wheel, with rolling resistance [1] and one number `by`.

    It is (front left + front right) + (rear left + rear right).
    """
    force_x = force_y = moment = tyre_power = friction_power = 0.0
    for axle in range(2):
        axle_x = axle_y = axle_moment = axle_tyre_power = axle_friction_power = 0.0
        for side in range(2):
            wheel = turn(y, dy, mechanics, 2 * axle + side, by[0], by[1])
            axle_x += wheel.x
            axle_y += wheel.y
            axle_moment += wheel.moment
            axle_tyre_power += wheel.tyre_power
            axle_friction_power += wheel.friction_power
        force_x += axle_x
        force_y += axle_y
        moment += axle_moment
        tyre_power += axle_tyre_power
        friction_power += axle_friction_power
    return OfWheel(force_x, force_y, moment, tyre_power, friction_power)


@inlined
def _turn_wheel(
    y: Row, dy: Row, mechanics: Mechanics, i: int, rolling: float, starts: bool
) -> OfWheel:
    """Set the rates of wheel i, its carcass and its contact; what it does to the body.

    `rolling` is the rolling resistance of the tyre [1], without that of the surface.
    """
    body, step = mechanics.body, mechanics.step
    at, wheel_speed = step.contact, step.contact.wheel_speed[i]
    along_force, across_force = _tyre_forces(y, dy, mechanics, i)
    step.force_x[i] = along_force
    step.force_y[i] = across_force

    radius = step.radius[i]
    # Brake and rolling resistance are one dry friction: they oppose the rotation, and hold a wheel
    # at rest as far as they go. The other torques are those of the drive and of the road.
    torque = step.drive[i] - radius * along_force
    dry = step.brake[i] + radius * step.load[i] * (rolling + step.tyre[i].rolling_resistance)
    if starts:
        decide_motion(step, i, wheel_speed, torque, dry)
    if step.held[i] == 1.0:
        dy[state.WHEEL_SPEED + i] = 0.0
    else:
        dy[state.WHEEL_SPEED + i] = (torque - step.motion[i] * dry) / body.wheel_inertia[i]
    dy[state.WHEEL_ANGLE + i] = wheel_speed
    dy[state.DISTANCE + i] = at.along[i]

    # From the frame of the wheel into that of the body; the moment is x F_y - y F_x.
    body_x = along_force * at.cosine[i] - across_force * at.sine[i]
    body_y = along_force * at.sine[i] + across_force * at.cosine[i]
    return OfWheel(
        body_x,
        body_y,
        body.wheel_x[i] * body_y - body.wheel_y[i] * body_x,
        # Force times slip velocity: what the contact turns into heat and the carcass stores.
        along_force * at.slip_x[i] + across_force * at.slip_y[i],
        step.motion[i] * dry * wheel_speed,
    )


@inlined
def _tyre_forces(y: Row, dy: Row, mechanics: Mechanics, i: int) -> tuple[float, float]:
    """Forces along and across wheel i [N]; sets the rates of its carcass and of its contact."""
    _, car, body, step = mechanics
    at, length = step.contact, car.tyre.contact_length
    stiffness_x, stiffness_y = car.tyre.longitudinal_stiffness, car.tyre.lateral_stiffness
    slip_x, slip_y = at.slip_x[i], at.slip_y[i]
    transport_x, transport_y = at.transport_x[i], at.transport_y[i]
    deflection_x, deflection_y = y[state.DEFLECTION_X + i], y[state.DEFLECTION_Y + i]
    along_force, rate_x = force_and_rate(
        deflection_x, slip_x, transport_x, at.secant_x[i], stiffness_x, body.damping_x
    )
    across_force, rate_y = force_and_rate(
        deflection_y, slip_y, transport_y, at.secant_y[i], stiffness_y, body.damping_y
    )
    # Beyond its friction the contact slides with the largest force, and the carcass unwinds.
    scale_x, scale_y = within_friction(car, at, i, along_force, across_force)
    if scale_x < 1.0:
        along_force *= scale_x
        rate_x = (along_force - stiffness_x * deflection_x) / body.damping_x
    if scale_y < 1.0:
        across_force *= scale_y
        rate_y = (across_force - stiffness_y * deflection_y) / body.damping_y
    dy[state.DEFLECTION_X + i] = rate_x
    dy[state.DEFLECTION_Y + i] = rate_y
    dy[state.SLIP_X + i] = slip_rate(y[state.SLIP_X + i], slip_x - rate_x, transport_x, length)
    dy[state.SLIP_Y + i] = slip_rate(y[state.SLIP_Y + i], slip_y - rate_y, transport_y, length)
    return along_force, across_force


@inlined
def _move_body(y: Row, dy: Row, mechanics: Mechanics, specific_x: float, specific_y: float) -> None:
    """Set the rates of the body but its yaw, under tyre forces over its mass [m/s^2]."""
    p, car, body, step = mechanics
    vx = y[state.VX]
    vy = y[state.VY]
    yaw_rate = y[state.YAW_RATE]
    drag = speed_resistance(car, body, vx)
    dy[state.DRAG_WORK] = drag * vx
    step.acceleration_x = specific_x - drag / car.mass + step.gravity_x
    # The force that holds a speed [N/kg] acts in the plane of the road below the centre of mass: it
    # neither turns nor pitches the car.
    holding = 0.0
    if p.speed != SPEED_FREE:
        # What is imposed is V_x' = a_x + r V_y, in the frame that turns with the body.
        wanted = step.imposed_acceleration - yaw_rate * vy
        holding = wanted - step.acceleration_x
        step.acceleration_x = wanted
    step.acceleration_y = specific_y + step.gravity_y
    if body.side_drag > 0.0:
        side_drag = body.side_drag * abs(vy) * vy
        step.acceleration_y -= side_drag / car.mass
        dy[state.DRAG_WORK] += side_drag * vy
    # In the frame that turns with the body: V_x' = a_x + r V_y, V_y' = a_y - r V_x.
    dy[state.VX] = step.acceleration_x + yaw_rate * vy
    dy[state.VY] = step.acceleration_y - yaw_rate * vx
    dy[state.HEADING] = yaw_rate
    # Only forces at the road have a lever about the centre of mass; drag and gravity act in it.
    dy[state.TRANSFER_X] = (specific_x + holding - y[state.TRANSFER_X]) / p.load_transfer_lag
    roll_lag = car.suspension.roll_lag if car.suspension.roll_lag > 0.0 else p.load_transfer_lag
    dy[state.TRANSFER_Y] = (specific_y - y[state.TRANSFER_Y]) / roll_lag
    dy[state.BODY_DISTANCE] = vx
    dy[state.GRAVITY_WORK] = -car.mass * (step.gravity_x * vx + step.gravity_y * vy)
    dy[state.HOLDING_WORK] = -car.mass * holding * vx


@inlined
def _roll_body(y: Row, dy: Row, mechanics: Mechanics, specific_y: float) -> None:
    """Set the rates of the body's roll under side forces of the tyres over the mass [m/s^2].

    A rigid body stays upright. The equations stand at the head of ev_core/vehicle/suspension.py.
    """
    roll = mechanics.body.roll
    if roll.rolls == 0.0:
        dy[state.ROLL_ANGLE] = dy[state.ROLL_RATE] = dy[state.DAMPER_WORK] = 0.0
        return
    angle, rate = y[state.ROLL_ANGLE], y[state.ROLL_RATE]
    held = roll.stiffness - roll.weight * mechanics.step.gravity_z
    moment = roll.weight * specific_y - held * angle - roll.damping * rate
    dy[state.ROLL_ANGLE] = rate
    dy[state.ROLL_RATE] = moment / roll.inertia
    dy[state.DAMPER_WORK] = roll.damping * rate * rate


@inlined
def push_at_wheels(y: Row, mechanics: Mechanics) -> None:
    """Add to the torques at the wheels what the imposed speed asks of mass and drag [N].

    A driver with motors and brakes would do the same. Driven wheels share it alike while it drives,
    the axles by their shares while it brakes. No wheel gets more than the side force that its
    carcass holds leaves of its friction: it neither spins nor locks.
    """
    p, car, body, step = mechanics
    vx = y[state.VX]
    force = car.mass * (
        step.imposed_acceleration - y[state.YAW_RATE] * y[state.VY] - step.gravity_x
    )
    force += speed_resistance(car, body, vx)
    bear(y, car, body, step)
    look(y, car, body, step, True)
    at = step.contact
    for i in range(4):
        # The friction ellipse: sqrt(1 - (F_y/F_y_max)^2) of the longitudinal friction is left. A
        # wheel off the ground has none; the 1 N keeps its division from 0/0.
        side = car.tyre.lateral_stiffness * y[state.DEFLECTION_Y + i] / max(at.largest_y[i], 1.0)
        left = at.largest_x[i] * sqrt(max(1.0 - side * side, 0.0))
        step.pushed[i] = 0.0
        # At rest it drives: a brake torque would only hold.
        if force * vx >= 0.0:
            wanted = abs(force) * car.driven[i] / max(car.number_driven, 1.0)
            step.pushed[i] = copysign(step.radius[i] * min(wanted, left), force)
            step.drive[i] += step.pushed[i]
        else:
            share = p.imposed_front_braking if i < 2 else 1.0 - p.imposed_front_braking
            step.brake[i] += step.radius[i] * min(0.5 * share * abs(force), left)


@inlined
def book_push(y: Row, step: Step) -> None:
    """Take what `push_at_wheels` added out of the drive torques: no motor gave it."""
    for i in range(4):
        # The work counts what is taken from the car, so what the push gives is negative.
        y[state.HOLDING_WORK] -= step.pushed[i] * step.turned[i]
        step.drive[i] -= step.pushed[i]


@inlined
def decide_motion(step: Step, i: int, wheel_speed: float, torque: float, dry: float) -> None:
    """Decide which direction dry friction opposes at wheel i during this step.

    Coulomb's law is set-valued at rest. `torque` and `dry` are the other torques and the largest
    friction torque on the wheel [N m].
    """
    step.held[i] = 0.0
    if dry == 0.0:
        step.motion[i] = 0.0
    elif wheel_speed != 0.0:
        step.motion[i] = 1.0 if wheel_speed > 0.0 else -1.0
    elif abs(torque) > dry:
        step.motion[i] = 1.0 if torque > 0.0 else -1.0
    else:
        step.motion[i] = 0.0
        step.held[i] = 1.0


@inlined
def integrate(y: Row, mechanics: Mechanics, h: float) -> None:
    """Advance the integrated part of the state in place by h [s].

    A wheel that dry friction has stopped within the step ends it at rest, exactly.
    """
    step = mechanics.step
    stages = step.stages
    stage = stages.state
    k1 = stages.k1
    k2 = stages.k2
    k3 = stages.k3
    k4 = stages.k4
    rates(y, k1, mechanics, True)
    for n in range(INTEGRATED_SIZE):
        stage[n] = y[n] + 0.5 * h * k1[n]
    rates(stage, k2, mechanics, False)
    for n in range(INTEGRATED_SIZE):
        stage[n] = y[n] + 0.5 * h * k2[n]
    rates(stage, k3, mechanics, False)
    for n in range(INTEGRATED_SIZE):
        stage[n] = y[n] + h * k3[n]
    rates(stage, k4, mechanics, False)
    for n in range(INTEGRATED_SIZE):
        y[n] += h / 6.0 * ((k1[n] + k4[n]) + 2.0 * (k2[n] + k3[n]))
    for i in range(4):
        if step.motion[i] * y[WHEEL_SPEED + i] < 0.0:
            y[WHEEL_SPEED + i] = 0.0


class Equations:
    """The integrated part of the plant under torques, a steering angle and a road that stay.

    y are the numbers that `state.INTEGRATED` names, shape (INTEGRATED_SIZE,). Everything is
    compiled.
    """

    def __init__(self, parameters: PlanarParameters, vehicle: Vehicle) -> None:
        self._car = one_record(car_numbers(vehicle))[0]
        self._body = one_record(body_constants(vehicle))[0]
        self._step = one_record(Step())[0]
        numbers = one_record(number_tree(parameters))[0]
        self._mechanics = Mechanics(numbers, self._car, self._body, self._step)
        road = road_tables(parameters.road, vehicle)
        self._road = type(road)(*(type(table)(*map(np.array, table)) for table in road))
        self._rates, self._advance = compiled(rates), compiled(integrate)
        self._hold, self._look = compiled(steer), compiled(find_road)

    def look(self, y: np.ndarray) -> None:
        """Take the road from where the car is now."""
        self._look(y, self._body, self._step, self._road, True)

    def hold(
        self, angle: float, drive: Sequence[float] = NO_WHEELS, brake: Sequence[float] = NO_WHEELS
    ) -> None:
        """Hold a mean road-wheel angle [rad], and drive and brake torques at the wheels [N m]."""
        self._step["drive"], self._step["brake"] = tuple(drive), tuple(brake)
        self._hold(self._car, self._step, angle, 0.0)

    def rates(self, y: np.ndarray, starts: bool = False) -> np.ndarray:
        """f(y); one that `starts` decides which direction dry friction opposes at each wheel."""
        dy = np.empty(INTEGRATED_SIZE)
        self._rates(y, dy, self._mechanics, starts)
        return dy

    def advance(self, y: np.ndarray, h: float) -> None:
        """Take one step of h [s] of the plant's own method, in place."""
        self._advance(y, self._mechanics, h)
