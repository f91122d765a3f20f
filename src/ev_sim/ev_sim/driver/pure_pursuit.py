"""Steering towards a point of the path that lies ahead (pure pursuit)."""

from __future__ import annotations

from dataclasses import dataclass

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.contract.signals import BodyPose
from ev_msgs_py.elementary import atan2, copysign
from ev_msgs_py.parameters.declaration import parameter
from ev_msgs_py.vehicle.car import Car
from ev_sim.driver.path import Path, nearest, point_at


@dataclass(frozen=True, slots=True)
class PurePursuitParameters:
    """How far ahead the driver looks."""

    preview_time: float = parameter(
        0.6, unit="s", low=0.0, high=10.0, about="the driver looks as far as the car goes in this time",
        source="assumption; 0.5 to 1.5 s are usual for drivers",
    )  # fmt: skip
    shortest_preview: float = parameter(
        4.0, unit="m", low=0.5, high=100.0, about="but at least this far", source="assumption"
    )
    max_angle: float = parameter(
        0.6, unit="rad", low=0.01, high=1.4, about="largest road-wheel angle, either way", source="assumption"
    )


@compilable
def pure_pursuit(
    p: PurePursuitParameters, car: Car, path: Path, pose: BodyPose, speed: float, leg: int
) -> tuple[float, int]:
    """Road-wheel angle [rad] at a speed, negative in reverse [m/s], and the leg of the path that is reached.

    The rear axle is to roll on the circle through the point of the path at the preview distance: tan delta =
    2 L y/(x^2 + y^2), (x, y) the point as seen from the rear axle (Coulter, Implementation of the pure pursuit path
    tracking algorithm, CMU-RI-TR-92-01, 1992). In reverse the point lies behind, the equation is the same: the rear
    axle, which leads then, does what it did forwards.
    """
    z, w = pose.orientation_z, pose.orientation_w
    cosine, sine = w * w - z * z, 2.0 * z * w  # of the heading, from its quaternion
    rear_arm = car.centre_of_mass_to_rear_axle
    rear_x, rear_y = pose.x - rear_arm * cosine, pose.y - rear_arm * sine
    preview = copysign(max(p.preview_time * abs(speed), p.shortest_preview), speed)
    distance, leg = nearest(path, rear_x, rear_y, leg)
    goal_x, goal_y = point_at(path, distance + preview, leg)
    ahead = (goal_x - rear_x) * cosine + (goal_y - rear_y) * sine
    aside = (goal_y - rear_y) * cosine - (goal_x - rear_x) * sine
    angle = atan2(2.0 * car.wheelbase * aside, ahead * ahead + aside * aside)
    return min(max(angle, -p.max_angle), p.max_angle), leg
