"""The kinematic plant as a method of the role `plant` (Shchur 2019, eqs 8 to 13)."""

from __future__ import annotations

import math

from ev_core.law import GRAVITY, Car, Vehicle, Wheels, compilable, copysign, cos, equal_motors, method, sin
from ev_msgs_py.contract.signals import SteeringColumnState, WheelTorqueCommand
from ev_sim.drives.drive import advance_drive
from ev_sim.plant.commands import GuardLimits, guard_limits, guarded_angle, guarded_torques
from ev_sim.plant.kinematic.ackermann import course_offset, path_curvature, wheel_speed_ratios
from ev_sim.plant.kinematic.state import (
    SIGNALS,
    KinematicPlantParameters,
    KinematicPlantState,
    notes,
    outputs,
    rolling_straight,
)


@compilable
def move_with_dry_friction(
    speed: float, force: float, friction: float, mass: float, duration: float
) -> tuple[float, float]:
    """Speed [m/s] and travelled distance [m] after `duration` [s] of m V' = F - F_friction sgn(V).

    The force is constant, `friction` >= 0 and `mass` > 0. Exact: a motion that friction brings to rest stops at its
    instant; at rest friction takes up any force within +-`friction`, a larger one breaks loose in its own direction.
    """
    distance = 0.0
    if speed != 0.0:
        acceleration = (force - copysign(friction, speed)) / mass
        stops = speed * acceleration < 0.0 and -speed / acceleration <= duration
        if not stops:
            return speed + acceleration * duration, (speed + acceleration * duration / 2.0) * duration
        distance = -speed * speed / (2.0 * acceleration)
        duration += speed / acceleration
    if abs(force) <= friction:
        return 0.0, distance
    acceleration = (force - copysign(friction, force)) / mass
    return acceleration * duration, distance + acceleration * duration * duration / 2.0


def limits(parameters: KinematicPlantParameters, vehicle: Vehicle, period: float) -> GuardLimits:
    """What commands may ask for.

    The paper's steering has no stop, its column swings beyond a right angle; eqs 8 to 11 hold at any angle.
    """
    return guard_limits(vehicle, parameters.motor.torque_limit, angle=math.inf)


@method(
    "plant",
    "kinematic",
    KinematicPlantParameters,
    state=KinematicPlantState,
    prepare=limits,
    start=rolling_straight,
    outputs=outputs,
    notes=notes,
    writes=SIGNALS,
    needs=(equal_motors,),
    heavy=True,
    mirrored=True,
)
@compilable
def kinematic(
    p: KinematicPlantParameters,
    car: Car,
    c: GuardLimits,
    s: KinematicPlantState,
    period: float,
    command: WheelTorqueCommand,
    column: SteeringColumnState,
) -> None:
    """Point mass, wheels that roll without slip on Ackermann's radii, resistance and brakes as dry friction.

    m V' = sum(M_j)/r_k - 0.5 rho c_d A V |V| - (k_r m g + sum(brake torques)/r_k) sgn(V), eq 13 with its traction
    equation; V_j = V R_j/R by eqs 8 to 11. As in the paper V is the speed of the centre of mass along its path, whose
    x and y components BodyVelocity carries, and the inertia of wheels, motors and yaw is left out. The road-wheel
    angle is held over a control period, so the car then moves on a circular arc, which is integrated exactly. Torques
    and angle are held as the guard accepts them.
    """
    held = guarded_torques(c, s.guard, command)
    steer(car, s, guarded_angle(c, s.guard, column))

    rolling_resistance = car.rolling_resistance * car.mass * GRAVITY
    friction = rolling_resistance + sum_of_wheels(held.brake) / car.wheel_radius
    drag = 0.5 * car.air_density * car.drag_coefficient * car.frontal_area
    sub_steps = max(1, math.ceil(period / p.sub_step - 1e-9))
    step = period / sub_steps
    speed_before = s.speed
    distance = 0.0
    for i in range(4):
        s.wheels[i].mean_torque = 0.0
    for _ in range(sub_steps):
        drive_torque = advance_drives(p, car, s, held.drive, step)
        force = drive_torque / car.wheel_radius - drag * s.speed * abs(s.speed)
        s.speed, moved = move_with_dry_friction(s.speed, force, friction, car.mass, step)
        distance += moved
    for i in range(4):
        s.wheels[i].mean_torque /= sub_steps
        s.wheels[i].position += s.wheels[i].speed_ratio * (distance / car.wheel_radius)
    s.acceleration = (s.speed - speed_before) / period
    move_on_arc(s, distance)


@compilable
def steer(car: Car, s: KinematicPlantState, road_wheel_angle: float) -> None:
    """Set the path of the centre of mass and the speed ratios of the wheels (eqs 8 to 11)."""
    base, behind = car.wheelbase, car.centre_of_mass_to_rear_axle
    s.path_curvature = path_curvature(road_wheel_angle, base, behind)
    s.course_offset = course_offset(road_wheel_angle, base, behind)
    ratios = wheel_speed_ratios(road_wheel_angle, base, car.front_track, car.rear_track, behind)
    for i in range(4):
        s.wheels[i].speed_ratio = ratios[i]


@compilable
def advance_drives(
    p: KinematicPlantParameters, car: Car, s: KinematicPlantState, torques: Wheels, step: float
) -> float:
    """Advance all drives over one step [s]; the sum of their torques at the wheels [N m], mean over the step."""
    return (advance_wheel(p, car, s, 0, torques[0], step) + advance_wheel(p, car, s, 1, torques[1], step)) + (
        advance_wheel(p, car, s, 2, torques[2], step) + advance_wheel(p, car, s, 3, torques[3], step)
    )


@compilable
def advance_wheel(
    p: KinematicPlantParameters, car: Car, s: KinematicPlantState, i: int, torque: float, step: float
) -> float:
    """Advance the drive of a wheel that is to give a torque there [N m]; what it gave, mean over the step."""
    if car.driven[i] == 0.0:
        return 0.0
    speed = car.gear_ratio * s.wheels[i].speed_ratio * s.speed / car.wheel_radius
    advance_drive(s.drives[i], p, torque / car.gear_ratio, speed, p.bus_voltage, step)
    given = car.gear_ratio * s.drives[i].mean_torque
    s.wheels[i].mean_torque += given
    return given


@compilable
def sum_of_wheels(values: Wheels) -> float:
    """Sum axle by axle, so that mirrored cars stay mirrored to the last bit."""
    return (values[0] + values[1]) + (values[2] + values[3])


@compilable
def move_on_arc(s: KinematicPlantState, distance: float) -> None:
    """Move along a circular arc [m]: the chord, at the mean of the courses at its ends."""
    half_turn = s.path_curvature * distance / 2.0
    chord = distance * (sin(half_turn) / half_turn if half_turn != 0.0 else 1.0)
    course = s.heading + half_turn + s.course_offset
    s.x += chord * cos(course)
    s.y += chord * sin(course)
    s.heading += 2.0 * half_turn
