"""Reports of runs that end before anything has happened.

Not measured, never an error, figures laid out for print.
"""

from __future__ import annotations

import pytest
from helpers.layouts import flaws

from ev_stack.figures.sheets import COLUMN, printed
from ev_stack.recording.offline import run_offline
from ev_stack.report.reports import report_for
from ev_stack.scenarios.files import scenario_names
from ev_stack.scenarios.scenario import Overrides, load_scenario

BEGIN = (("driver", "pedals.begin", True),)  # pedals from the start instead of the speed profile


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "duration", "values"),
    [
        *((name, 0.5, ()) for name in scenario_names()),
        *((name, 0.02, ()) for name in scenario_names()),
        ("steady_circle", 4.0, ()),
        ("steady_circle", None, BEGIN),
    ],
)
@pytest.mark.sampled
def test_a_report_bears_any_run(name, duration, values):
    scenario = load_scenario(name, Overrides(values=values, duration=duration))
    runs = {run.name: run_offline(run.configurations, run.duration) for run in scenario.runs}
    first = scenario.runs[0].configurations
    parameters = {role: configuration.values() for role, configuration in first.items()}
    report, vehicle, course = (
        report_for(name),
        first["plant"].common.vehicle,
        scenario.parameters.course,
    )
    metrics = report.metrics(runs, vehicle, parameters, course)
    assert metrics
    pages = printed(report.figures(runs, vehicle, parameters, course), COLUMN)
    assert {key: found for key, page in pages.items() if (found := flaws(page, COLUMN))} == {}
    if name == "steady_circle":
        assert all(
            metric.value is None for key, metric in metrics.items() if key.endswith("_gradient")
        )
