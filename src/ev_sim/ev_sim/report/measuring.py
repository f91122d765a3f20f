"""What is measured of one run: the metrics of its report, and those that its scenario or a command asks for besides."""

from __future__ import annotations

import traceback
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from ev_msgs_py.contract.roles import MASTER
from ev_msgs_py.refusal import ParameterError, unknown_name
from ev_sim.measures.metric import Metric
from ev_sim.measures.own_metrics import named_metric, named_metrics, own_metrics
from ev_sim.measures.registry import METRICS, driven_run, refuse_unmeasurable
from ev_sim.recording.recording import Recording
from ev_sim.report.result import report_for
from ev_sim.scenarios.scenario import Run


def measured_metrics(signals: Recording, run: Run) -> dict[str, Metric]:
    """By name the metrics of a run, of which the true motion is given."""
    parameters = {role: configuration.values() for role, configuration in run.configurations.items()}
    runs = {run.name: signals}
    of_report = report_for(run.report).metrics(runs, run.configurations[MASTER].common.vehicle, parameters, run.course)
    return {**of_report, **own_metrics(run.metrics, {run.name: driven_run(signals, run.configurations)})}


def known_metrics(run: Run) -> dict[str, Metric]:
    """The same, without values, before it is driven: what a run without samples gives.

    ParameterError that names the line if the report fails with such a run instead of raising NotMeasured.
    """
    try:
        return measured_metrics(Recording(np.zeros(0), {}), run)
    except Exception as error:  # whatever somebody's report raises
        last = traceback.extract_tb(error.__traceback__)[-1]
        raise ParameterError(
            f"report {run.report} fails with a run without samples, where metrics raise NotMeasured: "
            f"{type(error).__name__} {error} ({Path(last.filename).name}, line {last.lineno})"
        ) from error


def further_metrics(run: Run, texts: Sequence[str], must_exist: bool = True) -> tuple[str, ...]:
    """Those of some texts that ask for metrics which the run does not measure by itself.

    ParameterError for an unknown name, and if it `must_exist` for a metric of channels that the run will not have.
    """
    known = known_metrics(run)
    further = [text for text in texts if text not in known]
    for text in further:
        if text.isidentifier() and text not in METRICS:
            raise unknown_name("metric", text, [*known, *METRICS])
        if must_exist:
            refuse_unmeasurable([named_metric(text)], run.configurations)
    named_metrics([*run.metrics, *further])  # refuses names that are there twice
    return tuple(further)


def row_of(metrics: Mapping[str, Metric]) -> dict[str, Any]:
    """Metrics as a study keeps them: values by name, and of all their units, of those without a value why."""
    return {
        **{name: each.value for name, each in metrics.items() if each.value is not None},
        "units": {name: each.unit for name, each in metrics.items()},
        "reasons": {name: each.note for name, each in metrics.items() if each.value is None},
    }
