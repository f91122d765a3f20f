"""Which report a scenario gets, and what a report is."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from typing import Any

from ev_core.methods.offered import offered, offered_module
from ev_core.vehicle.description import Vehicle
from ev_sim.figures.figure import Figure
from ev_sim.measures.metric import Metric
from ev_sim.measures.samples import Parameters, Runs
from ev_sim.scenarios.about import REPORTS

ARGUMENTS = ("runs", "vehicle", "parameters")


@dataclass(frozen=True)
class Report:
    """Numbers and figures of the runs of a scenario, made by two functions of a module, `metrics` and `figures`.

    The functions name as arguments what they use of ARGUMENTS; TypeError if one names something else.
    """

    module: Any

    def metrics(self, runs: Runs, vehicle: Vehicle, parameters: Parameters) -> dict[str, Metric]:
        """Metrics by name, in the order of the table."""
        return _call(self.module.metrics, runs, vehicle, parameters)

    def figures(self, runs: Runs, vehicle: Vehicle, parameters: Parameters) -> dict[str, Figure]:
        """Figures by the name of their file without suffix."""
        return _call(self.module.figures, runs, vehicle, parameters)


def _call(function: Callable[..., Any], *given: Any) -> Any:
    by_name = dict(zip(ARGUMENTS, given, strict=True))
    names = inspect.signature(function).parameters
    for name in names:
        if name not in by_name:
            raise TypeError(f"{function.__module__}.{function.__name__}: {name} is none of {', '.join(ARGUMENTS)}")
    return function(**{name: by_name[name] for name in names})


def report_for(scenario: str) -> Report:
    """The report of a scenario: that of its name among the installed ones, or the generic one if there is none."""
    is_own = scenario in offered(REPORTS)
    return Report(offered_module(REPORTS, "report", scenario) if is_own else import_module("ev_sim.report.generic"))
