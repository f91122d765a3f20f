"""The report of a scenario, and that of any without one: speed, torques, steering angle, wheel speeds of each run."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from ev_core.methods.register import offered, offered_module
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_sim.figures.drawing import Curve, Figure, Panel, panel, sheet
from ev_sim.measures import motion
from ev_sim.measures.metric import Metric, Parameters, Runs, bus_metrics, channel, metric
from ev_sim.recording.recording import Recording
from ev_sim.scenarios.about import REPORTS

ARGUMENTS = ("runs", "vehicle", "parameters")


class Report(NamedTuple):
    """Metrics of the runs of a scenario in the order of the table, and figures by their file's name without suffix."""

    metrics: Callable[[Runs, Vehicle, Parameters], dict[str, Metric]]
    figures: Callable[[Runs, Vehicle, Parameters], dict[str, Figure]]


def report_for(scenario: str) -> Report:
    """The report of a scenario: that of its name among the installed ones, or that of any if there is none."""
    if scenario not in offered(REPORTS):
        return Report(_of_all(_any_metrics), _of_all(_any_figures))
    module = offered_module(REPORTS, "report", scenario)
    return Report(_of_all(module.metrics), _of_all(module.figures))


def _of_all(function: Callable[..., Any]) -> Callable[..., Any]:
    """A function that names as arguments what it uses of ARGUMENTS, called with all; TypeError if it names others."""

    def called(*given: Any) -> Any:
        by_name = dict(zip(ARGUMENTS, given, strict=True))
        names = inspect.signature(function).parameters
        for name in names:
            if name not in by_name:
                raise TypeError(f"{function.__module__}.{function.__name__}: {name} is none of {', '.join(ARGUMENTS)}")
        return function(**{name: by_name[name] for name in names})

    return called


def _any_metrics(runs: Runs) -> dict[str, Metric]:
    """Speeds and largest torque and angle of each run; the name of the run stands in front if there are several."""
    return motion.of_each_run(runs, _metrics)


def _any_figures(runs: Runs) -> dict[str, Figure]:
    """One sheet for each run."""
    return {
        f"overview_{name}" if len(runs) > 1 else "overview": sheet(_panels(run), "time [s]")
        for name, run in runs.items()
    }


def _metrics(run: Recording) -> dict[str, Metric]:
    return {
        "final_speed": metric(lambda: motion.path_speed(run)[-1], "m/s"),
        "maximum_speed": metric(lambda: motion.speed(run).max(), "m/s"),
        "maximum_total_drive_torque": metric(lambda: np.abs(motion.total_drive_torque(run)).max(), "N m"),
        "maximum_road_wheel_angle": metric(lambda: np.abs(channel(run, motion.ROAD_WHEEL_ANGLE)).max(), "rad"),
        **bus_metrics(run),
    }


def _panels(run: Recording) -> list[Panel]:
    def wheels(quantity: str) -> list[Curve]:
        return [Curve(run.time, channel(run, f"{quantity}.{name}"), name.replace("_", " ")) for name in WHEEL_NAMES]

    def steering_angle() -> list[Curve]:
        return [Curve(run.time, np.degrees(channel(run, motion.ROAD_WHEEL_ANGLE)))]

    return [
        panel("Speed", "speed [m/s]", lambda: [Curve(run.time, motion.path_speed(run))]),
        panel("Steering angle", "angle [deg]", steering_angle),
        panel("Drive torques", "torque [N m]", lambda: wheels("wheel_states.effort")),
        panel("Wheel speeds", "speed [rad/s]", lambda: wheels("wheel_states.velocity")),
    ]
