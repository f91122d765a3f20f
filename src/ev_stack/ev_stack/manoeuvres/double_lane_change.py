"""Report on a course between cones, such as ISO 3888: passing it, and the motion of the car."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ev_core.parameters.values import build
from ev_core.vehicle.description import Vehicle
from ev_sim.driver.off_path import distances_from
from ev_sim.driver.path import PathParameters, path_of
from ev_stack.figures.other_axes import plan_view
from ev_stack.figures.panels import Curve, motion_panels, readable
from ev_stack.figures.sheets import Sheet
from ev_stack.measures import motion
from ev_stack.measures.course import (
    Course,
    Lane,
    cones,
    edges,
    hit_cones,
    lanes_driven,
    outside_lanes,
)
from ev_stack.measures.metric import (
    HIGHER,
    LOWER,
    Metric,
    NotMeasured,
    Parameters,
    Runs,
    channel,
    metric,
)
from ev_stack.recording.recording import Recording

_PATH = "path."


def metrics(
    runs: Runs, vehicle: Vehicle, parameters: Parameters, course: Course
) -> dict[str, Metric]:
    """Pass or fail, cones hit, speeds, and largest values between the first and the last cone.

    Without a course in the scenario the values are those of the whole run.
    """
    road = _road_of(parameters)

    def of(run: Recording) -> dict[str, Metric]:
        def hit() -> int:
            # a car that leaves the course early touches no cones
            _end_of_course(run, vehicle, course)
            count = np.count_nonzero(hit_cones(run, vehicle, course))
            if not count and (left := _left(run, road, course, lanes_driven(run, vehicle, course))):
                raise NotMeasured(left)  # no cone stands where the car was
            return count

        def in_lanes() -> bool:
            # For its refusal: without a course there is nothing to pass.
            lanes_driven(run, vehicle, course)
            return passed(run, vehicle, road, course)

        def at(which: int) -> float:
            return motion.path_speed(run)[_on_course(run, vehicle, course)][which]

        def largest(values) -> float:
            return np.abs(values(run)[_on_course(run, vehicle, course)]).max()

        def of_channel(name: str) -> float:
            return largest(lambda run: channel(run, name))

        return {
            "course_passed": metric(
                in_lanes,
                "1",
                "1: in the lanes and on the road to the end, no cone hit; else 0",
                HIGHER,
            ),
            "cones_hit": metric(hit, "1", "cones that came to lie under the body", LOWER),
            "entry_speed": metric(lambda: at(0), "m/s", "V at the first cone"),
            "exit_speed": metric(lambda: at(-1), "m/s", "V at the last cone", HIGHER),
            "peak_lateral_acceleration": metric(
                lambda: largest(motion.lateral_acceleration_on_path),
                "m/s^2",
                "largest magnitude across the path, on the course",
            ),
            "peak_sideslip_angle": metric(
                lambda: largest(
                    lambda run: np.where(motion.moving(run), motion.sideslip_angle(run), 0.0)
                ),
                "rad",
                "max |beta| on the course while the car moves",
                LOWER,
            ),
            "peak_yaw_rate": metric(
                lambda: of_channel(motion.YAW_RATE), "rad/s", "max |r| on the course", LOWER
            ),
            "peak_steering_wheel_angle": metric(
                lambda: of_channel(motion.STEERING_WHEEL_ANGLE),
                "rad",
                "largest magnitude on the course",
                LOWER,
            ),
        }

    return motion.of_each_run(runs, of)


def _road_of(parameters: Parameters) -> PathParameters | None:
    """The path of the driver, in the middle of the road; None if he has none."""
    path = {
        name: value
        for name, value in parameters.get("driver", {}).items()
        if name.startswith(_PATH)
    }
    return build(PathParameters, path, _PATH) if path else None


def passed(run: Recording, vehicle: Vehicle, road: PathParameters | None, course: Course) -> bool:
    """Cleanness: 1 if the car stays in the lanes and on the road, and hits no cone; else 0.

    NotMeasured if it does neither leave them nor reach the end.
    """
    lanes = lanes_driven(run, vehicle, course) if course.begin else ()
    # A car that left is judged even where it never came to the end.
    if _left(run, road, course, lanes) or (course.begin and hit_cones(run, vehicle, course).any()):
        return False
    if course.begin:
        _end_of_course(run, vehicle, course)
    return True


def is_over(
    run: Recording, since: int, vehicle: Vehicle, road: PathParameters | None, course: Course
) -> bool:
    """End of the drive through a course: the car has left it, or is whole behind the last cone.

    At the sample `since` it had not.

    To which side its lanes go is known in the first lane aside: before, it has to have left those
    of both.
    """
    if not course.begin:
        # Only the part that was not looked at before: whole runs again and again would take long.
        return bool(_left(run.part(since), road, course, ()))
    # The tail, too, has to be past the last cone, which it could still hit.
    behind = course.end[-1] + vehicle.centre_of_mass_to_rear_axle + course.overhang
    is_behind = channel(run, "pose.x")[-1] >= behind
    return bool(
        is_behind
        or all(_left(run, road, course, course.lanes(vehicle, side)) for side in (1.0, -1.0))
    )


def figures(runs: Runs, vehicle: Vehicle, course: Course) -> dict[str, Sheet]:
    """The course with its cones and the car's path, and the motion over time."""
    name, run = next(iter(runs.items()))
    tracks = [Curve(channel(run, "pose.x"), channel(run, "pose.y"), "centre of mass")]
    sides = zip(("left", "right"), edges(run, vehicle, course), strict=True)
    tracks += [Curve(x, y, f"{side} side") for side, (x, y) in sides]
    marked = [cones(run, vehicle, course), hit_cones(run, vehicle, course)] if course.begin else []
    names = ("steering_wheel_angle", "lateral_acceleration", "yaw_rate", "sideslip_angle")
    return {
        "course": plan_view(course.title or readable(name), tracks, *marked),
        "motion": Sheet(motion_panels(runs, *names)),
    }


def _end_of_course(run: Recording, vehicle: Vehicle, course: Course) -> int:
    """Index of the first sample behind the last cone; NotMeasured if the car never is there."""
    end = lanes_driven(run, vehicle, course)[-1].end
    return motion.first(channel(run, "pose.x") >= end, "the end of the course")


def _on_course(run: Recording, vehicle: Vehicle, course: Course) -> np.ndarray:
    """Mark the samples between the first and the last cone, (n,) bool.

    Raises NotMeasured if the last cone is not reached.
    """
    x = channel(run, "pose.x")
    if not course.begin:
        return np.ones(len(x), bool)
    # Up to the first arrival: a car that turns round behind the course comes by again.
    return (x >= course.begin[0]) & (np.arange(len(x)) <= _end_of_course(run, vehicle, course))


def _left(
    run: Recording, road: PathParameters | None, course: Course, lanes: Sequence[Lane]
) -> str:
    """Place at which the car left the course up to its end, in one line; empty if it did not.

    It left a lane, or the road of the driver's path.

    That of the driver's path is as wide as `driver.path.width`.
    """
    x, y = channel(run, "pose.x"), channel(run, "pose.y")
    behind = x > course.end[-1] if course.begin else np.zeros(len(x), bool)
    # Behind the last cone the car may drive wherever it likes.
    until = int(behind.argmax()) if behind.any() else len(x)
    outside = {"its lane": outside_lanes(run, lanes)}
    if road:
        outside["the road"] = distances_from(path_of(road), x, y) > road.width / 2
    first = sorted(
        (int(where.argmax()), what) for what, where in outside.items() if where[:until].any()
    )
    return f"the car left {first[0][1]} at {run.time[first[0][0]]:.2f} s" if first else ""
