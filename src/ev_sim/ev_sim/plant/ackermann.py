"""Ackermann-Jeantaud steering: where each wheel goes when the car turns about one centre (Shchur 2019, eqs 8 to 12).

The centre of the turn lies on the line of the rear axle. The equations are multiplied through with sin(delta), so
they hold in straight running, and delta < 0 mirrors delta > 0: eq 11 as printed has lost the sign of delta and would
turn the front wheels backwards in a right turn. They are also continuous where the inner wheel stands across the car
(L/tan(delta) = d/2) and at 90 deg, where arctan would jump: the wheel angle then passes beyond 90 deg.

Everywhere: delta is the mean road-wheel angle, left positive [rad], |delta| < pi; lengths in m, above zero.
"""

from __future__ import annotations

from ev_core.law import Wheels, atan2, compilable, cos, hypot, sin


@compilable
def front_wheel_angles(road_wheel_angle: float, wheelbase: float, front_track: float) -> tuple[float, float]:
    """Angles of the left and the right front wheel, left positive [rad] (eq 8)."""
    ahead = wheelbase * sin(road_wheel_angle)
    to_centre = wheelbase * cos(road_wheel_angle)
    offset = sin(road_wheel_angle) * front_track / 2.0
    return atan2(ahead, to_centre - offset), atan2(ahead, to_centre + offset)


@compilable
def path_curvature(road_wheel_angle: float, wheelbase: float, centre_of_mass_to_rear_axle: float) -> float:
    """Curvature 1/R of the path of the centre of mass, positive to the left [1/m] (eq 11 with the sign of delta)."""
    return sin(road_wheel_angle) / _scaled_radius(road_wheel_angle, wheelbase, centre_of_mass_to_rear_axle)


@compilable
def course_offset(road_wheel_angle: float, wheelbase: float, centre_of_mass_to_rear_axle: float) -> float:
    """Angle from the car's x axis to the path of its centre of mass, left positive [rad]; from fig 2.

    It is the sideslip angle of a car that rolls forwards.
    """
    return atan2(centre_of_mass_to_rear_axle * sin(road_wheel_angle), wheelbase * cos(road_wheel_angle))


@compilable
def wheel_speed_ratios(
    road_wheel_angle: float, wheelbase: float, front_track: float, rear_track: float, centre_of_mass_to_rear_axle: float
) -> Wheels:
    """Speeds V_j of the rolling wheels over the speed V of the centre of mass, in the order of Wheels (eqs 8 to 10).

    The rear wheels roll on radii L/tan(delta) -+ d/2; the inner one rolls backwards where the centre of the turn lies
    between them.
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
def _scaled_radius(road_wheel_angle: float, wheelbase: float, centre_of_mass_to_rear_axle: float) -> float:
    """|R sin(delta)|, which stays finite in straight running [m] (eq 11)."""
    return hypot(wheelbase * cos(road_wheel_angle), centre_of_mass_to_rear_axle * sin(road_wheel_angle))
