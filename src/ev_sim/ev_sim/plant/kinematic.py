"""The kinematic plant: a point mass on wheels that roll without slip (Shchur 2019, eqs 8 to 13).

How it works: a period is divided into sub-steps. In each the drives see the speeds of their wheels
and give torques, and the point mass moves under their sum, exactly up to the instant at which dry
friction stops it. The road-wheel angle is held over the period, so the path is an arc: pose and
wheel angles follow from its length, at the end.

Ackermann-Jeantaud steering: the centre of the turn lies on the line of the rear axle. The equations
are multiplied through with sin(delta), so they hold in straight running, and delta < 0 mirrors
delta > 0: eq 11 as printed has lost the sign of delta and would turn the front wheels backwards in
a right turn. They are also continuous where the inner wheel stands across the car (L/tan(delta) =
d/2) and at 90 deg, where arctan would jump: the wheel angle then passes beyond 90 deg. delta is the
mean road-wheel angle, left positive [rad], |delta| < pi; lengths in m, above zero.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from ev_core.elementary import atan2, copysign, cos, hypot, sin
from ev_core.law import (
    GRAVITY,
    Car,
    Vehicle,
    Wheels,
    compilable,
    each_wheel,
    entry,
    equal_motors,
    method,
    part,
)
from ev_core.parameters.declaration import setting
from ev_msgs_py.contract import signals
from ev_sim.drives.brushless_motor import DriveState
from ev_sim.drives.drive import DriveParameters, advance_drive
from ev_sim.drives.driveline import behind_gear
from ev_sim.plant.guard import (
    Commanded,
    GuardLimits,
    GuardState,
    guard_limits,
    guard_notes,
    guarded_angle,
    guarded_torques,
)

_SIGNALS = (
    signals.WheelStates,
    signals.MotorStates,
    signals.InertialMeasurement,
    signals.BodyVelocity,
    signals.BodyPose,
)


@dataclass(frozen=True, slots=True)
class KinematicPlantParameters(DriveParameters):
    """Drives, supply and integration of the kinematic plant; the car is the vehicle description."""

    bus_voltage: float = setting(
        480.0,
        unit="V",
        low=1.0,
        high=2000.0,
        about="constant; the EMF of the paper's second turn is 190 V",
    )
    sub_step: float = setting(
        1e-3,
        unit="s",
        low=1e-6,
        high=1e-3,
        about="longest step of the motion, over which the drives see one speed",
    )
    initial_speed: float = setting(
        0.0, unit="m/s", low=-100.0, high=100.0, about="speed at the start"
    )


@dataclass(slots=True)
class RollingWheelState:
    """A wheel that rolls without slip."""

    position: float = entry(unit="rad", about="turned angle")
    speed_ratio: float = entry(
        1.0, unit="1", about="speed of the wheel over that of the centre of mass, V_j/V"
    )
    mean_torque: float = entry(
        unit="N m", about="of the drive at the wheel, over the last control period"
    )


@dataclass(slots=True)
class KinematicPlantState:
    """The car on its path, its wheels and drives, and the commands that were accepted last."""

    speed: float = entry(
        unit="m/s", about="V, of the centre of mass along its path, backwards negative"
    )
    acceleration: float = entry(
        unit="m/s^2", about="along the path, mean over the last control period"
    )
    path_curvature: float = entry(unit="1/m", about="1/R, positive to the left")
    course_offset: float = entry(
        unit="rad", about="from the car's x axis to the path, left positive"
    )
    x: float = entry(unit="m", about="of the centre of mass in odom")
    y: float = entry(unit="m", about="of the centre of mass in odom")
    heading: float = entry(unit="rad", about="of the car in odom")
    wheels: list[RollingWheelState] = each_wheel(RollingWheelState)
    drives: list[DriveState] = each_wheel(DriveState)
    guard: GuardState = part(GuardState)


@compilable
def outputs(car: Car, s: KinematicPlantState) -> tuple:
    """The signals of this instant.

    Wheel torques and acceleration are means over the control period before it. The means are what
    moved the car, chopping and commutation ripple included; the motors' torque is the one of this
    instant, so it shows the ripple. Of the road-wheel angle the plant knows what was held until
    now.
    """
    yaw_rate = s.speed * s.path_curvature
    along, across = cos(s.course_offset), sin(s.course_offset)
    centripetal = s.speed * yaw_rate
    one = s.wheels[0]
    two = s.wheels[1]
    three = s.wheels[2]
    four = s.wheels[3]
    velocity = Wheels(
        one.speed_ratio * s.speed / car.wheel_radius,
        two.speed_ratio * s.speed / car.wheel_radius,
        three.speed_ratio * s.speed / car.wheel_radius,
        four.speed_ratio * s.speed / car.wheel_radius,
    )
    return (
        signals.WheelStates(
            Wheels(one.position, two.position, three.position, four.position),
            velocity,
            Wheels(one.mean_torque, two.mean_torque, three.mean_torque, four.mean_torque),
        ),
        signals.MotorStates(
            Wheels(
                shaft_speed(car, 0, velocity[0]),
                shaft_speed(car, 1, velocity[1]),
                shaft_speed(car, 2, velocity[2]),
                shaft_speed(car, 3, velocity[3]),
            ),
            Wheels(s.drives[0].torque, s.drives[1].torque, s.drives[2].torque, s.drives[3].torque),
        ),
        signals.InertialMeasurement(
            yaw_rate,
            # Along and across the path, turned by the course offset into the axes of the car.
            s.acceleration * along - centripetal * across,
            s.acceleration * across + centripetal * along,
        ),
        signals.BodyVelocity(s.speed * along, s.speed * across, yaw_rate),
        signals.BodyPose(s.x, s.y, sin(s.heading / 2), cos(s.heading / 2)),
    )


@compilable
def shaft_speed(car: Car, wheel: int, wheel_speed: float) -> float:
    """Speed of the motor of a wheel at its shaft [rad/s]; 0 where there is none."""
    return car.gear_ratio * wheel_speed if car.driven[wheel] == 1.0 else 0.0


@compilable
def move_with_dry_friction(
    speed: float, force: float, friction: float, mass: float, duration: float
) -> tuple[float, float]:
    """Speed [m/s] and travelled distance [m] after `duration` [s] of m V' = F - F_friction sgn(V).

    The force is constant, `friction` >= 0 and `mass` > 0. Exact: a motion that friction brings to
    rest stops at its instant; at rest friction takes up any force within +-`friction`, a larger one
    breaks loose in its own direction.
    """
    distance = 0.0
    if speed != 0.0:
        acceleration = (force - copysign(friction, speed)) / mass
        stops = speed * acceleration < 0.0 and -speed / acceleration <= duration
        if not stops:
            return speed + acceleration * duration, (
                speed + acceleration * duration / 2.0
            ) * duration
        distance = -speed * speed / (2.0 * acceleration)
        # speed/acceleration is minus the time in which the motion stops.
        duration += speed / acceleration
    if abs(force) <= friction:
        return 0.0, distance
    acceleration = (force - copysign(friction, force)) / mass
    return acceleration * duration, distance + acceleration * duration * duration / 2.0


def limits(parameters: KinematicPlantParameters, vehicle: Vehicle, period: float) -> GuardLimits:
    """Limits of the commands.

    The paper's steering has no stop, its column swings beyond a right angle; eqs 8 to 11 hold at
    any angle.
    """
    return guard_limits(vehicle, parameters.motor.torque_limit, angle=math.inf)


def steered_by_ackermann(_parameters: KinematicPlantParameters, vehicle: Vehicle) -> str:
    """Need front wheels that turn about one centre: no other wheels roll without slip."""
    if vehicle.steering_geometry == "ackermann":
        return ""
    return "vehicle.steering_geometry ackermann"


@method(
    "plant",
    "kinematic",
    prepare=limits,
    start=lambda p: KinematicPlantState(speed=p.initial_speed),
    outputs=outputs,
    notes=lambda s: guard_notes(s.guard),
    writes=_SIGNALS,
    needs=(equal_motors, steered_by_ackermann),
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
    commanded: Commanded,
) -> None:
    """Point mass on wheels that roll without slip; resistance and brakes are dry friction.

    m V' = sum(M_j)/r_k - 0.5 rho c_d A V |V| - (k_r m g + sum(brake torques)/r_k) sgn(V), eq 13
    with its traction equation; V_j = V R_j/R by eqs 8 to 11. Beyond the paper k_r may grow with the
    speed, and gears may have losses. As in the paper V is the speed of the centre of mass along its
    path; BodyVelocity carries its x and y components. The inertia of wheels, motors and yaw is left
    out. The road-wheel angle is held over a control period, so the car then moves on a circular
    arc, which is integrated exactly. Torques and angle are held as the guard accepts them.
    """
    # Once in a period: command, path and what resists stay while it lasts.
    held = guarded_torques(c, s.guard, commanded.torques)
    angle = guarded_angle(c, s.guard, commanded.column)
    base = car.wheelbase
    behind = car.centre_of_mass_to_rear_axle
    s.path_curvature = path_curvature(angle, base, behind)
    s.course_offset = course_offset(angle, base, behind)
    ratios = wheel_speed_ratios(angle, base, car.front_track, car.rear_track, behind)
    brake, torques = held.brake, held.drive
    # Sums go axle by axle, so that mirrored cars stay mirrored to the last bit.
    brakes = ((brake[0] + brake[1]) + (brake[2] + brake[3])) / car.wheel_radius
    drag = 0.5 * car.air_density * car.drag_coefficient * car.frontal_area + car.road_load.quadratic
    # A period of a whole number of sub-steps gets no more than that by rounding.
    sub_steps = max(1, math.ceil(period / p.sub_step - 1e-9))
    step = period / sub_steps
    speed_before = s.speed
    distance = 0.0
    for i in range(4):
        s.wheels[i].mean_torque, s.wheels[i].speed_ratio = 0.0, ratios[i]
    for _ in range(sub_steps):
        front = advance_wheel(p, car, s, 0, torques[0], step) + advance_wheel(
            p, car, s, 1, torques[1], step
        )
        rear = advance_wheel(p, car, s, 2, torques[2], step) + advance_wheel(
            p, car, s, 3, torques[3], step
        )
        force = (
            (front + rear) / car.wheel_radius
            - drag * s.speed * abs(s.speed)
            - car.road_load.linear * s.speed
        )
        rolling = car.constant_rolling_resistance + car.rolling_resistance_growth * (
            s.speed * s.speed
        )
        friction = rolling * car.mass * GRAVITY + brakes
        s.speed, moved = move_with_dry_friction(s.speed, force, friction, car.mass, step)
        distance += moved
    for i in range(4):
        s.wheels[i].mean_torque /= sub_steps
        s.wheels[i].position += s.wheels[i].speed_ratio * (distance / car.wheel_radius)
    s.acceleration = (s.speed - speed_before) / period
    move_on_arc(s, distance)


@compilable
def advance_wheel(
    p: KinematicPlantParameters,
    car: Car,
    s: KinematicPlantState,
    i: int,
    torque: float,
    step: float,
) -> float:
    """Advance the drive of a wheel towards a torque there [N m]; its mean over the step [N m]."""
    if car.driven[i] == 0.0:
        return 0.0
    speed = car.gear_ratio * s.wheels[i].speed_ratio * s.speed / car.wheel_radius
    advance_drive(s.drives[i], p, torque / car.gear_ratio, speed, p.bus_voltage, step)
    given = behind_gear(car, car.gear_ratio * s.drives[i].mean_torque, speed)
    s.wheels[i].mean_torque += given
    return given


@compilable
def move_on_arc(s: KinematicPlantState, distance: float) -> None:
    """Move along a circular arc [m]: the chord, at the mean of the courses at its ends."""
    half_turn = s.path_curvature * distance / 2.0
    chord = distance * (sin(half_turn) / half_turn if half_turn != 0.0 else 1.0)
    course = s.heading + half_turn + s.course_offset
    s.x += chord * cos(course)
    s.y += chord * sin(course)
    s.heading += 2.0 * half_turn


@compilable
def front_wheel_angles(
    road_wheel_angle: float, wheelbase: float, front_track: float
) -> tuple[float, float]:
    """Angles of the left and the right front wheel, left positive [rad] (eq 8)."""
    ahead = wheelbase * sin(road_wheel_angle)
    to_centre = wheelbase * cos(road_wheel_angle)
    offset = sin(road_wheel_angle) * front_track / 2.0
    return atan2(ahead, to_centre - offset), atan2(ahead, to_centre + offset)


@compilable
def path_curvature(
    road_wheel_angle: float, wheelbase: float, centre_of_mass_to_rear_axle: float
) -> float:
    """Curvature 1/R of the path of the centre of mass, positive to the left [1/m].

    It is eq 11 with the sign of delta.
    """
    return sin(road_wheel_angle) / _scaled_radius(
        road_wheel_angle, wheelbase, centre_of_mass_to_rear_axle
    )


@compilable
def course_offset(
    road_wheel_angle: float, wheelbase: float, centre_of_mass_to_rear_axle: float
) -> float:
    """Angle from the car's x axis to the path of its centre of mass, left positive [rad] (fig 2).

    It is the sideslip angle of a car that rolls forwards.
    """
    return atan2(
        centre_of_mass_to_rear_axle * sin(road_wheel_angle), wheelbase * cos(road_wheel_angle)
    )


@compilable
def wheel_speed_ratios(
    road_wheel_angle: float,
    wheelbase: float,
    front_track: float,
    rear_track: float,
    centre_of_mass_to_rear_axle: float,
) -> Wheels:
    """Speeds V_j of the rolling wheels over the speed V of the centre of mass (eqs 8 to 10).

    The rear wheels roll on radii L/tan(delta) -+ d/2; the inner one rolls backwards where the
    centre of the turn lies between them.
    """
    ahead = wheelbase * sin(road_wheel_angle)
    to_centre = wheelbase * cos(road_wheel_angle)
    front_offset = sin(road_wheel_angle) * front_track / 2.0
    rear_offset = sin(road_wheel_angle) * rear_track / 2.0
    radius = _scaled_radius(road_wheel_angle, wheelbase, centre_of_mass_to_rear_axle)
    return Wheels(
        hypot(ahead, to_centre - front_offset) / radius,
        hypot(ahead, to_centre + front_offset) / radius,
        (to_centre - rear_offset) / radius,
        (to_centre + rear_offset) / radius,
    )


@compilable
def _scaled_radius(
    road_wheel_angle: float, wheelbase: float, centre_of_mass_to_rear_axle: float
) -> float:
    """|R sin(delta)|, which stays finite in straight running [m] (eq 11)."""
    return hypot(
        wheelbase * cos(road_wheel_angle), centre_of_mass_to_rear_axle * sin(road_wheel_angle)
    )
