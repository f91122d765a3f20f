"""Report on laps of a closed course: times, distance from the limits of the car, and cost."""

from __future__ import annotations

import numpy as np

from ev_core.parameters.values import build
from ev_core.vehicle.description import Vehicle
from ev_sim.courses.course import CourseParameters, edges
from ev_stack.figures.other_axes import plan_view
from ev_stack.figures.panels import Curve, motion_panels
from ev_stack.figures.sheets import Sheet
from ev_stack.measures import motion
from ev_stack.measures.laps import line_of
from ev_stack.measures.metric import Metric, Parameters, Runs, channel
from ev_stack.measures.named import DrivenRun
from ev_stack.measures.registry import METRICS
from ev_stack.recording.recording import Recording

_COURSE = "course."
_OF_A_LAP = (
    "lap_time", "path_error", "mean_friction_use", "high_friction_use", "maximum_speed", "peak_sideslip", "slip_energy",
    "battery_energy",
)  # fmt: skip


def course_of(parameters: Parameters) -> CourseParameters | None:
    """Closed course of a driver that has one."""
    own = {
        name: value
        for name, value in parameters.get("driver", {}).items()
        if name.startswith(_COURSE)
    }
    return build(CourseParameters, own, _COURSE) if own else None


def metrics(runs: Runs, vehicle: Vehicle, parameters: Parameters) -> dict[str, Metric]:
    """Lap time, path error, use of the friction ellipse, and energies of each run."""

    def of(run: Recording) -> dict[str, Metric]:
        driven = DrivenRun(run, vehicle, course=course_of(parameters))
        return {name: METRICS[name].measured(driven) for name in _OF_A_LAP}

    return motion.of_each_run(runs, of)


def figures(runs: Runs, vehicle: Vehicle, parameters: Parameters) -> dict[str, Sheet]:
    """The course with its edges, the racing line and the car's path, and the motion over time."""
    course = course_of(parameters)
    tracks = [
        Curve(channel(run, "pose.x"), channel(run, "pose.y"), name) for name, run in runs.items()
    ]
    if course is not None:
        lines = (*edges(course), line_of(course, vehicle).points)
        closed = (np.vstack((line, line[:1])).T for line in lines)
        tracks += [
            Curve(x, y, of)
            for of, (x, y) in zip(("left edge", "right edge", "racing line"), closed, strict=True)
        ]
    names = ("speed", "lateral_acceleration", "yaw_rate", "sideslip_angle")
    return {
        "course": plan_view("Closed course", tracks),
        "motion": Sheet(motion_panels(runs, *names)),
    }
