"""A driver who looks ahead: knows his car, and slows down before bends."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from ev_core.law import Car, Vehicle, compilable, group, method, part, speed_along_path
from ev_msgs_py.contract.signals import BodyPose, BodyVelocity, DriverCommand, Instant, SteeringColumnState
from ev_sim.driver.lane_keeping import STANDING, HandParameters
from ev_sim.driver.manoeuvre import FeetParameters, FeetProfiles, FeetState, feet_profiles, work_pedals
from ev_sim.driver.path import Path, PathParameters, RoadEdgeState, edge_notes, path_of, watch_edge
from ev_sim.driver.preview.gains import PreviewParameters
from ev_sim.driver.preview.speed_plan import (
    SpeedPlan,
    SpeedPlanParameters,
    SpeedPlanState,
    plan_notes,
    planned_speed,
    speed_plan,
)
from ev_sim.driver.preview.steering import Preview, PreviewState, look_ahead, preview_of
from ev_sim.driver.steering import AngleControlState, turn_to_angle
from ev_sim.profiles.profile import with_speed_profile_from_file


@dataclass(frozen=True, slots=True)
class PreviewDriverParameters(FeetParameters):
    """The path, how fast the driver takes its bends, how he looks ahead, and hands and feet."""

    path: PathParameters = group(PathParameters)
    plan: SpeedPlanParameters = group(SpeedPlanParameters)
    preview: PreviewParameters = group(PreviewParameters)
    hands: HandParameters = group(HandParameters)


@dataclass(slots=True)
class PreviewDriverState:
    """What feet, eyes and hands remember."""

    feet: FeetState = part(FeetState)
    plan: SpeedPlanState = part(SpeedPlanState)
    preview: PreviewState = part(PreviewState)
    hands: AngleControlState = part(AngleControlState)
    edge: RoadEdgeState = part(RoadEdgeState)


class Course(NamedTuple):
    """What the feet follow, the path, how fast it may be driven, and what the driver knows of his car."""

    feet: FeetProfiles
    path: Path
    plan: SpeedPlan
    preview: Preview


def course_of(parameters: PreviewDriverParameters, vehicle: Vehicle, period: float) -> Course:
    """The course that the parameters describe; ParameterError if they name a profile file that has not been read."""
    path = path_of(parameters.path)
    return Course(
        feet_profiles(parameters, vehicle, period),
        path,
        speed_plan(parameters.plan, path),
        preview_of(parameters.preview, vehicle, period),
    )


def notes(p: PreviewDriverParameters, s: PreviewDriverState) -> tuple[str, ...]:
    """Whether the car was too fast for the plan, and whether it has left its road."""
    return (*plan_notes(s.plan), *edge_notes(s.edge, p.path.width))


@method(
    "driver",
    "preview",
    PreviewDriverParameters,
    state=PreviewDriverState,
    prepare=course_of,
    load_files=with_speed_profile_from_file,
    notes=notes,
    mirrored=True,
)
@compilable
def preview(
    p: PreviewDriverParameters,
    car: Car,
    c: Course,
    s: PreviewDriverState,
    period: float,
    now: Instant,
    body: BodyVelocity,
    pose: BodyPose,
    column: SteeringColumnState,
) -> DriverCommand:
    """Steer along a path by optimal preview with the car's single-track model, and slow down before its bends."""
    speed = speed_along_path(body)
    if abs(speed) > STANDING:
        s.preview.direction = 1.0 if speed > 0.0 else -1.0
    wheels = column.angle / car.steering_ratio
    angle = look_ahead(p.preview, c.preview, c.path, s.preview, period, pose, body, speed, wheels)
    leg = int(s.preview.leg)
    fastest = planned_speed(p.plan, c.plan, c.path, s.plan, now.time, pose.x, pose.y, leg, speed)
    drive, brake = work_pedals(p, car, c.feet, s.feet, period, now.time, speed, fastest)
    watch_edge(c.path, p.path.width, s.edge, now.time, pose, leg)
    return DriverCommand(
        drive, brake, turn_to_angle(p.hands.angle_control, s.hands, period, car.steering_ratio * angle, column)
    )
