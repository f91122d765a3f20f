"""Report on the double lane change (ISO 3888-1): cones hit, and what the car does on its way through the lanes."""

from __future__ import annotations

import numpy as np

from ev_msgs_py.vehicle.description import Vehicle
from ev_sim.report.figures.drawing import sheet
from ev_sim.report.figures.figure import Figure
from ev_sim.report.figures.over_time import motion_panels
from ev_sim.report.figures.panels import Curve
from ev_sim.report.figures.plan_view import plan_view
from ev_sim.report.metric import Metric, metric
from ev_sim.report.quantities import derived, motion
from ev_sim.report.quantities import lane_change_course as course
from ev_sim.report.samples import Runs, channel
from ev_sim.running.recording.recording import Recording


def metrics(runs: Runs, vehicle: Vehicle) -> dict[str, Metric]:
    """Cones hit, speed at the entry and largest values between the first and the last cone, for each run."""

    def of(run: Recording) -> dict[str, Metric]:
        def largest(values) -> float:
            return np.abs(values(run)[_on_course(run, vehicle)]).max()

        return {
            "cones_hit": metric(lambda: _cones_hit(run, vehicle), "1"),
            "entry_speed": metric(lambda: derived.speed(run)[_on_course(run, vehicle)][0], "m/s"),
            "exit_speed": metric(lambda: derived.speed(run)[_on_course(run, vehicle)][-1], "m/s"),
            "peak_lateral_acceleration": metric(lambda: largest(motion.lateral_acceleration_on_path), "m/s^2"),
            "peak_sideslip_angle": metric(lambda: largest(motion.sideslip_angle), "rad"),
            "peak_yaw_rate": metric(lambda: largest(lambda run: channel(run, motion.YAW_RATE)), "rad/s"),
            "peak_steering_wheel_angle": metric(
                lambda: largest(lambda run: channel(run, motion.STEERING_WHEEL_ANGLE)), "rad"
            ),
        }

    return motion.of_each_run(runs, of)


def figures(runs: Runs, vehicle: Vehicle) -> dict[str, Figure]:
    """The course with its cones and the car's path, and the motion over time."""
    run = next(iter(runs.values()))
    tracks = [Curve(channel(run, "pose.x"), channel(run, "pose.y"), "centre of mass")]
    tracks += [
        Curve(x, y, f"{side} side") for side, (x, y) in zip(("left", "right"), course.edges(run, vehicle), strict=True)
    ]
    names = ("steering_wheel_angle", "lateral_acceleration", "yaw_rate", "sideslip_angle")
    return {
        "course": plan_view(
            "Double lane change, ISO 3888-1",
            tracks,
            course.cones(vehicle, course.side_of(run)),
            course.hit_cones(run, vehicle),
        ),
        "motion": sheet(motion_panels(runs, *names), "time [s]"),
    }


def _cones_hit(run: Recording, vehicle: Vehicle) -> int:
    _on_course(run, vehicle)  # who leaves the course early spares its cones
    return np.count_nonzero(course.hit_cones(run, vehicle))


def _on_course(run: Recording, vehicle: Vehicle) -> np.ndarray:
    """Which samples lie between the first and the last cone, (n,) bool; NotMeasured if the last one is not reached."""
    x = channel(run, "pose.x")
    lanes = course.lanes(vehicle, course.side_of(run))
    first, last = lanes[0].start, lanes[-1].end
    end = motion.first(x >= last, "the end of the course")
    return (x >= first) & (np.arange(len(x)) <= end)
