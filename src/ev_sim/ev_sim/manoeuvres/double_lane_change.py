"""Report on the lane changes of ISO 3888: cones hit, and what the car does on its way through the lanes."""

from __future__ import annotations

from functools import partial

import numpy as np

from ev_core.vehicle.description import Vehicle
from ev_sim.figures.other_axes import plan_view
from ev_sim.figures.panels import Curve, motion_panels
from ev_sim.figures.sheets import Sheet
from ev_sim.measures import motion
from ev_sim.measures.lane_change_course import DOUBLE_LANE_CHANGE, Course, cones, edges, hit_cones, lanes, side_of
from ev_sim.measures.metric import Metric, Runs, channel, metric
from ev_sim.recording.recording import Recording


def metrics_on(course: Course, runs: Runs, vehicle: Vehicle) -> dict[str, Metric]:
    """Cones hit, speed at the entry and largest values between the first and the last cone, for each run."""

    def of(run: Recording) -> dict[str, Metric]:
        def hit() -> int:
            _on_course(course, run, vehicle)  # who leaves the course early spares its cones
            return np.count_nonzero(hit_cones(run, vehicle, course))

        def largest(values) -> float:
            return np.abs(values(run)[_on_course(course, run, vehicle)]).max()

        return {
            "cones_hit": metric(hit, "1"),
            "entry_speed": metric(lambda: motion.path_speed(run)[_on_course(course, run, vehicle)][0], "m/s"),
            "exit_speed": metric(lambda: motion.path_speed(run)[_on_course(course, run, vehicle)][-1], "m/s"),
            "peak_lateral_acceleration": metric(lambda: largest(motion.lateral_acceleration_on_path), "m/s^2"),
            "peak_sideslip_angle": metric(lambda: largest(motion.sideslip_angle), "rad"),
            "peak_yaw_rate": metric(lambda: largest(lambda run: channel(run, motion.YAW_RATE)), "rad/s"),
            "peak_steering_wheel_angle": metric(
                lambda: largest(lambda run: channel(run, motion.STEERING_WHEEL_ANGLE)), "rad"
            ),
        }

    return motion.of_each_run(runs, of)


def figures_on(course: Course, runs: Runs, vehicle: Vehicle) -> dict[str, Sheet]:
    """The course with its cones and the car's path, and the motion over time."""
    run = next(iter(runs.values()))
    tracks = [Curve(channel(run, "pose.x"), channel(run, "pose.y"), "centre of mass")]
    tracks += [Curve(x, y, f"{side} side") for side, (x, y) in zip(("left", "right"), edges(run, vehicle), strict=True)]
    names = ("steering_wheel_angle", "lateral_acceleration", "yaw_rate", "sideslip_angle")
    return {
        "course": plan_view(
            course.name, tracks, cones(vehicle, side_of(run, course), course), hit_cones(run, vehicle, course)
        ),
        "motion": Sheet(motion_panels(runs, *names)),
    }


def _on_course(course: Course, run: Recording, vehicle: Vehicle) -> np.ndarray:
    """Which samples lie between the first and the last cone, (n,) bool; NotMeasured if the last one is not reached."""
    x = channel(run, "pose.x")
    through = lanes(vehicle, side_of(run, course), course)
    first, last = through[0].start, through[-1].end
    end = motion.first(x >= last, "the end of the course")
    return (x >= first) & (np.arange(len(x)) <= end)


metrics, figures = partial(metrics_on, DOUBLE_LANE_CHANGE), partial(figures_on, DOUBLE_LANE_CHANGE)
