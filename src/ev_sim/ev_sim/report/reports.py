"""Which report a scenario gets, and what a report is."""

from __future__ import annotations

import inspect
import pkgutil
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from importlib import import_module
from typing import Any

from ev_msgs_py.parameters.values import unknown_name
from ev_msgs_py.vehicle.description import Vehicle
from ev_sim.report import scenarios
from ev_sim.report.figures.figure import Figure
from ev_sim.report.metric import Metric
from ev_sim.report.own_metrics import parsed
from ev_sim.report.samples import Parameters, Runs

OWN_REPORTS = tuple(module.name for module in pkgutil.iter_modules(scenarios.__path__))
GIVEN = ("runs", "vehicle", "parameters")


@dataclass(frozen=True)
class Report:
    """Numbers and figures of the runs of a scenario, made by two functions of a module, `metrics` and `figures`.

    The functions name as arguments what they use of GIVEN; TypeError if one names something else.
    """

    module: Any

    def metrics(self, runs: Runs, vehicle: Vehicle, parameters: Parameters) -> dict[str, Metric]:
        """Metrics by name, in the order of the table."""
        return _call(self.module.metrics, runs, vehicle, parameters)

    def figures(self, runs: Runs, vehicle: Vehicle, parameters: Parameters) -> dict[str, Figure]:
        """Figures by the name of their file without suffix."""
        return _call(self.module.figures, runs, vehicle, parameters)


def _call(function: Callable[..., Any], *given: Any) -> Any:
    by_name = dict(zip(GIVEN, given, strict=True))
    names = inspect.signature(function).parameters
    for name in names:
        if name not in by_name:
            raise TypeError(f"{function.__module__}.{function.__name__}: {name} is none of {', '.join(GIVEN)}")
    return function(**{name: by_name[name] for name in names})


def refuse_unknown_report(report: str, metrics: Sequence[str]) -> None:
    """ParameterError if a scenario names a report that there is not, or a metric of its own that is none."""
    if report and report not in OWN_REPORTS:
        raise unknown_name("report", report, OWN_REPORTS)
    for text in metrics:
        parsed(text)


def report_for(scenario: str) -> Report:
    """The report of a scenario: the module of its name in `scenarios`, or the generic one if there is none."""
    own = f"{scenarios.__name__}.{scenario}" if scenario in OWN_REPORTS else "ev_sim.report.generic"
    return Report(import_module(own))
