"""One step of body and wheels by one evaluation of the forces (`integrator: semi_implicit`).

How it works: loads, directions of the wheels and friction curves are looked up once, in the middle
of the step, to which the rates of the step before lead. There the secant of the curve makes a
viscous element of each contact. So its carcass, its slip and the spin of its wheel are linear
equations, which the implicit midpoint rule solves for each wheel: this is what would be stiff. Then
forces are known, and the body follows by the same rule. All works are forces times mean velocities
of the step, so the energies add up to rounding, however long the step is. Dry friction is decided
at the start of a step, as the Runge-Kutta method does (`body.decide_motion`).

The error falls with the square of the step, also where a torque jumps from one step to the next:
it acts in its own step, and the rates that lead to the middle are those without drives and brakes.
"""

from __future__ import annotations

from typing import NamedTuple

from ev_core.law import copysign, inlined
from ev_sim.plant.planar import planar_state as state
from ev_sim.plant.planar.body import OfWheel, bear, decide_motion, of_all_wheels
from ev_sim.plant.planar.contact import look, speed_resistance, within_friction
from ev_sim.plant.planar.given import SPEED_FREE
from ev_sim.plant.planar.model import Mechanics
from ev_sim.plant.planar.planar_state import RATES_SIZE, WHEEL_SPEED, Row
from ev_sim.tyres.contact_patch import RENEWAL, Pair, force_and_rate, slip_rate


class OfTyre(NamedTuple):
    """Forces along and across a wheel [N], and rates of its carcass [m/s], means of the step."""

    force_x: float
    force_y: float
    rate_x: float
    rate_y: float


class Moved(NamedTuple):
    """Mean velocities of the body over a step."""

    vx: float  # [m/s]
    vy: float  # [m/s]
    yaw_rate: float  # [rad/s]


@inlined
def integrate_once(y: Row, rates: Row, mechanics: Mechanics, h: float) -> None:
    """Advance the integrated part of the state in place by h [s].

    `rates` are those of the step before, of wheels by the road alone, and become those of this
    one.
    """
    _, car, body, step = mechanics
    middle = step.stages.state
    _lead_to_middle(y, rates, mechanics, h)
    vx = middle[state.VX]
    bear(middle, car, body, step)
    look(middle, car, body, step, True)
    rolling = car.constant_rolling_resistance + car.rolling_resistance_growth * vx * vx
    wheels = of_all_wheels(_turn_wheel, y, rates, mechanics, (rolling, h))
    roll_rate = _roll_body(y, rates, mechanics, wheels.y / car.mass, h)
    rates[state.YAW_RATE] = wheels.moment / car.yaw_inertia
    moved = _move_body(y, rates, mechanics, wheels, h)
    # The centre of mass sways over the axles as the body rolls.
    sideways = moved.vy + body.roll.lever * roll_rate
    body_power = wheels.x * moved.vx + wheels.y * sideways + wheels.moment * moved.yaw_rate
    y[state.TYRE_WORK] += h * (wheels.tyre_power - body_power)
    y[state.FRICTION_WORK] += h * wheels.friction_power
    for n in range(RATES_SIZE):
        y[n] += h * rates[n]
    for i in range(4):
        if step.held[i] == 1.0:
            y[WHEEL_SPEED + i] = 0.0  # exactly, also where it has just stopped
        # What is left is by road and carcass.
        torque = step.drive[i] - step.motion[i] * step.brake[i]
        rates[WHEEL_SPEED + i] -= torque / body.wheel_inertia[i]


@inlined
def _lead_to_middle(y: Row, rates: Row, mechanics: Mechanics, h: float) -> None:
    """Set the state in the middle of a step, as far as forces depend on it."""
    body, step = mechanics.body, mechanics.step
    middle = step.stages.state
    for n in range(RATES_SIZE):
        middle[n] = y[n] + 0.5 * h * rates[n]
    for i in range(4):
        speed = y[WHEEL_SPEED + i]
        # Drive and brake torque are known already, and may have jumped since the step before.
        torque = step.drive[i] - copysign(step.brake[i], speed)
        middle[WHEEL_SPEED + i] += 0.5 * h * torque / body.wheel_inertia[i]
        # A wheel that dry friction stops does not turn back, and one at rest is not yet released.
        if middle[WHEEL_SPEED + i] * speed <= 0.0:
            middle[WHEEL_SPEED + i] = 0.0


@inlined
def _turn_wheel(
    y: Row, rates: Row, mechanics: Mechanics, i: int, rolling: float, h: float
) -> OfWheel:
    """Set the rates of wheel i, its carcass and its contact; what it does to the body.

    `rolling` is the rolling resistance of the tyre [1], without that of the surface.
    """
    body, step = mechanics.body, mechanics.step
    at, radius, drive = step.contact, step.radius[i], step.drive[i]
    wheel_speed = y[WHEEL_SPEED + i]
    dry = step.brake[i] + radius * step.load[i] * (rolling + step.tyre[i].rolling_resistance)
    slip = -at.along[i]
    tyre = OfTyre(0.0, 0.0, 0.0, 0.0)
    if wheel_speed == 0.0:
        # As if it were held: the force of the road decides whether it is.
        tyre = _tyre(y, mechanics, i, slip, h)
    decide_motion(step, i, wheel_speed, drive - radius * tyre.force_x, dry)
    spin = 0.0
    if step.held[i] == 0.0:
        torque = drive - step.motion[i] * dry
        slip = _mean_slip(y, mechanics, i, torque, h)
        tyre = _tyre(y, mechanics, i, slip, h)
        spin = (torque - radius * tyre.force_x) / body.wheel_inertia[i]
        if step.motion[i] * (wheel_speed + h * spin) < 0.0:
            stopped = radius * tyre.force_x - body.wheel_inertia[i] * wheel_speed / h
            asked = step.motion[i] * (drive - stopped)
            if asked >= -dry:
                # Stopped within the step: dry friction took less than it could have.
                step.held[i] = 1.0
                spin = -wheel_speed / h
                torque, dry = stopped, asked
            else:
                # More than friction turns it back: friction opposes the rest of the step, too.
                dry *= -2.0 * wheel_speed / (h * spin) - 1.0
                torque = drive - step.motion[i] * dry
                slip = _mean_slip(y, mechanics, i, torque, h)
                tyre = _tyre(y, mechanics, i, slip, h)
                spin = (torque - radius * tyre.force_x) / body.wheel_inertia[i]
    mean_speed = wheel_speed + 0.5 * h * spin
    rates[state.DEFLECTION_X + i] = tyre.rate_x
    rates[state.DEFLECTION_Y + i] = tyre.rate_y
    # Where friction limits the force, or stops the wheel, it turned otherwise than by `slip`.
    sliding_x = radius * mean_speed - at.along[i] - tyre.rate_x
    _slide(y, rates, mechanics, i, (sliding_x, at.slip_y[i] - tyre.rate_y), h)
    y[state.WHEEL_ANGLE + i] += h * mean_speed
    y[state.DISTANCE + i] += h * at.along[i]
    rates[WHEEL_SPEED + i] = spin

    # From the frame of the wheel into that of the body; the moment is x F_y - y F_x.
    body_x = tyre.force_x * at.cosine[i] - tyre.force_y * at.sine[i]
    body_y = tyre.force_x * at.sine[i] + tyre.force_y * at.cosine[i]
    return OfWheel(
        body_x,
        body_y,
        body.wheel_x[i] * body_y - body.wheel_y[i] * body_x,
        radius * tyre.force_x * mean_speed,
        step.motion[i] * dry * mean_speed,
    )


@inlined
def _mean_slip(y: Row, mechanics: Mechanics, i: int, torque: float, h: float) -> float:
    """Mean slip velocity along wheel i over the step [m/s], under a torque on it [N m].

    The force of the road on the wheel is linear in it, and the wheel turns by both.
    """
    _, car, body, step = mechanics
    at, radius, stiffness = step.contact, step.radius[i], car.tyre.longitudinal_stiffness
    damping = body.damping_x + 0.5 * h * stiffness
    contact = at.secant_x[i] / (at.secant_x[i] + at.transport_x[i] * damping)
    held = contact * stiffness * y[state.DEFLECTION_X + i]
    # Rim speed that a torque gives until the middle of the step, over the torque.
    yielding = 0.5 * h * radius / body.wheel_inertia[i]
    free = radius * y[WHEEL_SPEED + i] - at.along[i] + yielding * (torque - radius * held)
    return free / (1.0 + yielding * radius * contact * damping)


@inlined
def _tyre(y: Row, mechanics: Mechanics, i: int, slip_x: float, h: float) -> OfTyre:
    """Forces and carcass rates of wheel i at a mean slip velocity along it [m/s].

    The mean deflection is u + h u'/2. So the implicit rule is the equation of `force_and_rate` with
    a damping of d + h k/2 in place of d.
    """
    _, car, body, step = mechanics
    at = step.contact
    stiffness_x, stiffness_y = car.tyre.longitudinal_stiffness, car.tyre.lateral_stiffness
    damping_x = body.damping_x + 0.5 * h * stiffness_x
    damping_y = body.damping_y + 0.5 * h * stiffness_y
    deflection_x, deflection_y = y[state.DEFLECTION_X + i], y[state.DEFLECTION_Y + i]
    force_x, rate_x = force_and_rate(
        deflection_x, slip_x, at.transport_x[i], at.secant_x[i], stiffness_x, damping_x
    )
    force_y, rate_y = force_and_rate(
        deflection_y, at.slip_y[i], at.transport_y[i], at.secant_y[i], stiffness_y, damping_y
    )
    # Beyond its friction the contact slides with the largest force, and the carcass unwinds.
    scale_x, scale_y = within_friction(car, at, i, force_x, force_y)
    if scale_x < 1.0:
        force_x *= scale_x
        rate_x = (force_x - stiffness_x * deflection_x) / damping_x
    if scale_y < 1.0:
        force_y *= scale_y
        rate_y = (force_y - stiffness_y * deflection_y) / damping_y
    return OfTyre(force_x, force_y, rate_x, rate_y)


@inlined
def _slide(y: Row, rates: Row, mechanics: Mechanics, i: int, sliding: Pair, h: float) -> None:
    """Set the rates of the slip of contact i, which slides at mean velocities [m/s].

    As with the carcass, the implicit rule is the same equation with another length.
    """
    _, car, _, step = mechanics
    at, length = step.contact, car.tyre.contact_length
    transport_x, transport_y = at.transport_x[i], at.transport_y[i]
    length_x = length + 0.5 * h * max(transport_x, RENEWAL)
    length_y = length + 0.5 * h * max(transport_y, RENEWAL)
    rates[state.SLIP_X + i] = slip_rate(y[state.SLIP_X + i], sliding[0], transport_x, length_x)
    rates[state.SLIP_Y + i] = slip_rate(y[state.SLIP_Y + i], sliding[1], transport_y, length_y)


@inlined
def _move_body(y: Row, rates: Row, mechanics: Mechanics, wheels: OfWheel, h: float) -> Moved:
    """Set the rates of the body but its yaw and roll, and book the works on it."""
    p, car, body, step = mechanics
    pushed_x, pushed_y = wheels.x / car.mass, wheels.y / car.mass
    middle = step.stages.state
    half = 0.5 * h
    yaw_rate = y[state.YAW_RATE] + half * rates[state.YAW_RATE]
    drag = speed_resistance(car, body, middle[state.VX])
    side_drag = body.side_drag * abs(middle[state.VY]) * middle[state.VY]
    along = pushed_x - drag / car.mass + step.gravity_x
    across = pushed_y - side_drag / car.mass + step.gravity_y
    # In the frame that turns with the body: V_x' = a_x + r V_y, V_y' = a_y - r V_x, with mean
    # velocities on the right, so that turning the frame takes no energy.
    free_x = y[state.VX] + half * along
    free_y = y[state.VY] + half * across
    turned = half * yaw_rate
    holding = 0.0
    if p.speed == SPEED_FREE:
        vx = (free_x + turned * free_y) / (1.0 + turned * turned)
        vy = free_y - turned * vx
    else:
        vx = y[state.VX] + half * step.imposed_acceleration
        vy = free_y - turned * vx
        # The force that holds a speed [N/kg], as in `body._move_body`.
        holding = step.imposed_acceleration - yaw_rate * vy - along
    rates[state.VX] = along + holding + yaw_rate * vy
    rates[state.VY] = across - yaw_rate * vx
    rates[state.HEADING] = yaw_rate
    roll_lag = car.suspension.roll_lag if car.suspension.roll_lag > 0.0 else p.load_transfer_lag
    followed_x = pushed_x + holding - y[state.TRANSFER_X]
    followed_y = pushed_y - y[state.TRANSFER_Y]
    rates[state.TRANSFER_X] = followed_x / (p.load_transfer_lag + half)
    rates[state.TRANSFER_Y] = followed_y / (roll_lag + half)
    y[state.BODY_DISTANCE] += h * vx
    y[state.DRAG_WORK] += h * (drag * vx + side_drag * vy)
    y[state.GRAVITY_WORK] -= h * car.mass * (step.gravity_x * vx + step.gravity_y * vy)
    y[state.HOLDING_WORK] -= h * car.mass * holding * vx
    return Moved(vx, vy, yaw_rate)


@inlined
def _roll_body(y: Row, rates: Row, mechanics: Mechanics, specific_y: float, h: float) -> float:
    """Set the rates of the body's roll, and book the work of its dampers; mean roll rate [rad/s].

    `specific_y` are the side forces of the tyres over the mass [m/s^2].
    """
    roll = mechanics.body.roll
    if roll.rolls == 0.0:
        rates[state.ROLL_ANGLE] = rates[state.ROLL_RATE] = 0.0
        return 0.0
    half = 0.5 * h
    angle, rate = y[state.ROLL_ANGLE], y[state.ROLL_RATE]
    held = roll.stiffness - roll.weight * mechanics.step.gravity_z
    moment = roll.weight * specific_y - held * angle - roll.damping * rate
    # Springs and dampers at the mean angle and rate, as of the carcass.
    resisting = roll.inertia + half * (roll.damping + half * held)
    rates[state.ROLL_RATE] = (moment - half * held * rate) / resisting
    mean = rate + half * rates[state.ROLL_RATE]
    rates[state.ROLL_ANGLE] = mean
    y[state.DAMPER_WORK] += h * roll.damping * mean * mean
    return mean
