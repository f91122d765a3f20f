"""Every metric: those of any run, and those of each report, as they are known before a run is driven."""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

from documentation.markdown import code, codes, table
from ev_core.methods.offered import offered
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_stack.measures.derived import SERIES
from ev_stack.measures.expression import AT, ELEMENTWISE, OVER_TIME, REDUCTIONS
from ev_stack.measures.metric import Metric
from ev_stack.measures.own_metrics import named_metrics
from ev_stack.measures.registry import METRICS
from ev_stack.report.reports import known_metrics
from ev_stack.scenarios.about import REPORTS
from ev_stack.scenarios.files import scenario_names
from ev_stack.scenarios.scenario import load_scenario

_WHEELS = re.compile("|".join(WHEEL_NAMES))


def metrics_of_any_run() -> str:
    """The registry."""
    rows = ((code(m.name), m.unit, m.formula, m.better, codes(m.needs)) for m in METRICS.values())
    return table(("metric", "unit", "what is computed", "better", "channels"), rows)


def functions_of_expressions() -> str:
    """What an expression may call."""
    of = {
        "one number of a channel": REDUCTIONS,
        f"the value at an instant, `{AT}(imu.yaw_rate, 3)`": [AT],
        "over time": OVER_TIME,
        "sample by sample": ELEMENTWISE,
    }
    return table(("gives", "functions"), ((what, codes(names)) for what, names in of.items()))


def series_of_expressions() -> str:
    """The series that an expression knows besides the channels."""
    rows = (
        (code(name), each.unit, each.formula, codes(each.needs)) for name, each in SERIES.items()
    )
    return table(("series", "unit", "what it is", "channels"), rows)


def metrics_of_reports() -> str:
    """A section for each report with the scenarios that have it; what is judged by a published id stands elsewhere."""
    scenarios: dict[str, list[str]] = {}
    for name in scenario_names():
        report = load_scenario(name).runs[0].report
        scenarios.setdefault(report if report in offered(REPORTS) else "", []).append(name)
    return "\n".join(_section(report, names) for report, names in sorted(scenarios.items()))


def _section(report: str, scenarios: Sequence[str]) -> str:
    loaded = load_scenario(report or scenarios[0])
    runs = sorted((run.name for run in loaded.runs), key=len, reverse=True)
    own = named_metrics(loaded.parameters.metrics)
    found = {
        _general(name, runs): metric
        for name, metric in known_metrics(loaded.runs).items()
        if name not in own
    }
    rows = list(_rows((name, metric) for name, metric in found.items() if "." not in name))
    judged = (
        ""
        if len(rows) == len(found)
        else f"\n{'Besides these, w' if rows else 'W'}hat its source is judged by"
    )
    head = (
        f"### {report or 'scenarios without a report'}\n\n{'That' if report else 'Those'} of"
        f" {codes(scenarios)}.\n"
    )
    columns = ("metric", "unit", "what is computed", "better")
    link = f"{judged} ([verdicts](verdicts.md)).\n" if judged else ""
    return head + (f"\n{table(columns, rows)}" if rows else "") + link


def _rows(metrics: Iterable[tuple[str, Metric]]) -> Iterable[Sequence[str]]:
    return ((code(name), each.unit, each.formula, each.better) for name, each in metrics)


def _general(name: str, runs: Sequence[str]) -> str:
    """A name with RUN and WHEEL in the place of those of the single ones."""
    name = _WHEELS.sub("WHEEL", name)
    for run in runs if len(runs) > 1 else ():
        if name.startswith(f"{run}_"):
            return f"RUN{name.removeprefix(run)}"
        if name.endswith(f"_{run}"):
            return f"{name.removesuffix(run)}RUN"
    return name
