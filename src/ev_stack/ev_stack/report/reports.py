"""Reports of scenarios: metrics and figures of their runs."""

from __future__ import annotations

import inspect
import traceback
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ev_core.methods.offered import offered, offered_module
from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.roles import MASTER
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_msgs_py.refusal import ParameterError, unknown_name
from ev_stack.figures.panels import Curve, Panel, motion_panels, panel, readable
from ev_stack.figures.sheets import Sheet
from ev_stack.measures import motion
from ev_stack.measures.course import NO_COURSE, Course
from ev_stack.measures.metric import Metric, Parameters, Runs, channel
from ev_stack.measures.named import DrivenRun, driven_run, refuse_unmeasurable
from ev_stack.measures.own_metrics import named_metric, named_metrics, own_metrics
from ev_stack.measures.registry import METRICS, metrics_of_others
from ev_stack.recording.recording import Recording
from ev_stack.scenarios.about import REPORTS
from ev_stack.scenarios.records import Run

ARGUMENTS = ("runs", "vehicle", "parameters", "course")
_OVERVIEW = (
    "final_speed",
    "maximum_speed",
    "maximum_total_drive_torque",
    "maximum_road_wheel_angle",
)


class Report(NamedTuple):
    """Metrics of the runs of a scenario in the order of the table, and figures by file name.

    Both are of ARGUMENTS; the course may be left out where there is none.
    """

    metrics: Callable[..., dict[str, Metric]]
    figures: Callable[..., dict[str, Sheet]]


def report_for(scenario: str) -> Report:
    """Find the report of a scenario by its name, or the report of any scenario if it has none."""
    if scenario not in offered(REPORTS):
        return Report(_of_all(_any_metrics), _of_all(_any_figures))
    module = offered_module(REPORTS, "report", scenario)
    return Report(_of_all(module.metrics), _of_all(module.figures))


def _of_all(function: Callable[..., Any]) -> Callable[..., Any]:
    """Check that a function takes only arguments of ARGUMENTS, and call it with those it takes."""

    def called(
        runs: Runs, vehicle: Vehicle, parameters: Parameters, course: Course = NO_COURSE
    ) -> Any:
        by_name = dict(zip(ARGUMENTS, (runs, vehicle, parameters, course), strict=True))
        names = inspect.signature(function).parameters
        for name in names:
            if name not in by_name:
                raise TypeError(
                    f"{function.__module__}.{function.__name__}: {name} is none of"
                    f" {', '.join(ARGUMENTS)}"
                )
        return function(**{name: by_name[name] for name in names})

    return called


def _any_metrics(runs: Runs, vehicle: Vehicle) -> dict[str, Metric]:
    """Speeds and largest torque and angle of each run; with several runs, their names in front."""

    def of(run: Recording) -> dict[str, Metric]:
        found = {name: METRICS[name].measured(DrivenRun(run, vehicle)) for name in _OVERVIEW}
        return {**found, **metrics_of_others(DrivenRun(run, vehicle))}

    return motion.of_each_run(runs, of)


def _any_figures(runs: Runs) -> dict[str, Sheet]:
    """One sheet for each run."""
    return {
        f"overview_{name}" if len(runs) > 1 else "overview": Sheet(_panels(run))
        for name, run in runs.items()
    }


def _panels(run: Recording) -> list[Panel]:
    def wheels(quantity: str) -> list[Curve]:
        return [
            Curve(run.time, channel(run, f"{quantity}.{name}"), readable(name))
            for name in WHEEL_NAMES
        ]

    return [
        *motion_panels({"": run}, "speed", "road_wheel_angle"),
        panel("Drive torques", "torque [N m]", lambda: wheels("wheel_states.effort")),
        panel("Wheel speeds", "wheel speed [rad/s]", lambda: wheels("wheel_states.velocity")),
        *(_roll_panel(run) if motion.ROLL in run.channels else ()),
    ]


def _roll_panel(run: Recording) -> list[Panel]:
    angle = motion.roll_angle(run)
    return [Panel("Roll", "roll angle [deg]", [Curve(run.time, np.degrees(angle))])]


def measured_metrics(signals: Recording, run: Run) -> dict[str, Metric]:
    """Metrics of one run by name; its true motion is given."""
    return metrics_of_runs({run.name: signals}, [run])


def metrics_of_runs(signals: Runs, runs: Sequence[Run]) -> dict[str, Metric]:
    """Metrics of the runs of a scenario by name, its own before those of its report.

    The vehicle, the parameters and the course are those of the first run.
    """
    driven = {run.name: driven_run(signals[run.name], run.configurations) for run in runs}
    return {**_of_report("metrics", signals, runs[0]), **own_metrics(runs[0].metrics, driven)}


def figures_of_runs(signals: Runs, runs: Sequence[Run]) -> dict[str, Sheet]:
    """Figures of the report of a scenario by name."""
    return dict(_of_report("figures", signals, runs[0]))


def _of_report(what: str, signals: Runs, first: Run) -> Any:
    parameters = {
        role: configuration.values() for role, configuration in first.configurations.items()
    }
    vehicle = first.configurations[MASTER].common.vehicle
    return getattr(report_for(first.report), what)(signals, vehicle, parameters, first.course)


def known_metrics(runs: Sequence[Run]) -> dict[str, Metric]:
    """The same, without values, before anything is driven: what runs without samples give.

    ParameterError that names the line if the report fails with such runs instead of raising
    NotMeasured.
    """
    # Every metric of it is NotMeasured, but names, units and formulas are there.
    nothing = Recording(np.zeros(0), {})
    try:
        return metrics_of_runs({run.name: nothing for run in runs}, runs)
    except Exception as error:  # any error of a user's report
        last = traceback.extract_tb(error.__traceback__)[-1]
        raise ParameterError(
            f"report {runs[0].report} fails with a run without samples, where metrics raise"
            f" NotMeasured: {type(error).__name__} {error} ({Path(last.filename).name}, line"
            f" {last.lineno})"
        ) from error


def further_metrics(run: Run, texts: Sequence[str], must_exist: bool = True) -> tuple[str, ...]:
    """Those of some texts that ask for metrics which the run does not measure by itself.

    ParameterError for an unknown name, and if it `must_exist` for a metric of channels that the run
    will not have.
    """
    known = known_metrics([run])
    further = [text for text in texts if text not in known]
    for text in further:
        # An identifier is a name; what is none is an expression, which is read below.
        if text.isidentifier() and text not in METRICS:
            raise unknown_name("metric", text, [*known, *METRICS])
        if must_exist:
            refuse_unmeasurable([named_metric(text)], run.configurations)
    named_metrics([*run.metrics, *further])  # refuses names that are there twice
    return tuple(further)


def row_of(metrics: Mapping[str, Metric]) -> dict[str, Any]:
    """Metrics by name as a study keeps them: values, units, better direction, and reasons for gaps.

    The values are in a mapping of their own: a metric of a user's may have any name.
    """
    return {
        "metrics": {name: each.value for name, each in metrics.items() if each.value is not None},
        "units": {name: each.unit for name, each in metrics.items()},
        "reasons": {name: each.note for name, each in metrics.items() if each.value is None},
        "better": {name: each.better for name, each in metrics.items() if each.better},
    }
