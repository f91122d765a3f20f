"""Metrics that users name or write: `NAME` of the registry, or `NAME [UNIT] = EXPRESSION`."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator, Mapping, Sequence

from ev_msgs_py.contract import frame
from ev_msgs_py.refusal import ParameterError, quoted, unknown_name
from ev_stack.measures.derived import SERIES
from ev_stack.measures.expression import REDUCTIONS, name_of, number_of, parsed
from ev_stack.measures.metric import Metric
from ev_stack.measures.named import DrivenRun, NamedMetric
from ev_stack.measures.registry import METRICS

FORM = (
    "NAME [UNIT] = EXPRESSION, such as rms_ay [m/s^2] = root_mean_square(imu.lateral_acceleration)"
)


def named_metric(text: str | NamedMetric) -> NamedMetric:
    """A registered metric by its name, or the one that an expression declares.

    Raises ParameterError, in one line, if the text is neither.

    The unit may be left out of a reduction of a channel, which has that of the channel. A metric is
    itself.
    """
    if isinstance(text, NamedMetric):
        return text
    if text.strip() in METRICS:
        return METRICS[text.strip()]
    # `=` but not `==`; the counts bound what a long line makes the pattern try.
    found = re.fullmatch(
        r"\s*(\w{1,100})\s*(?:\[([^\[\]]{1,20})\])?\s*=(?!=)\s*(.+?)\s*", text, re.DOTALL
    )
    if found is None:
        if re.fullmatch(r"\s*\w+\s*", text):
            raise unknown_name("metric", text.strip(), METRICS)
        raise ParameterError(
            f"metric {quoted(text)} is refused, expected a name of docs/metrics.md, or {FORM}"
        )
    name, unit, expression = found.groups()
    try:
        if name in METRICS:
            raise ParameterError(f"{name} is the name of another metric, expected one of your own")
        tree = parsed(expression)
        of = number_of(tree)
        unit = unit.strip() if unit else _unit_of(tree)
    except ParameterError as error:
        raise ParameterError(f"metric {quoted(text)} is refused: {error}") from None
    # Each need once, in an order that is always the same, unlike that of a set.
    return NamedMetric(name, unit, expression, of, tuple(dict.fromkeys(_needs(tree))))


def named_metrics(texts: Sequence[str | NamedMetric]) -> dict[str, NamedMetric]:
    """Metrics of some texts by name; ParameterError also for a name that is listed twice."""
    found: dict[str, NamedMetric] = {}
    for text in texts:
        each = named_metric(text)
        if each.name in found:
            raise ParameterError(f"metric {quoted(each.name)} is there twice, expected once")
        found[each.name] = each
    return found


def own_metrics(texts: Sequence[str], runs: Mapping[str, DrivenRun]) -> dict[str, Metric]:
    """The metrics of each run; the name of the run stands in front if there are several."""
    named = named_metrics(texts)
    return {
        f"{name}_{key}" if len(runs) > 1 else key: each.measured(run)
        for key, each in named.items()
        for name, run in runs.items()
    }


def listed(text: str) -> tuple[str, ...]:
    """The texts that commas separate, but not those within parentheses or brackets."""
    found, depth = [""], 0
    for each in text:
        # A comma between arguments belongs to its expression.
        depth += (each in "([") - (each in ")]")
        if each == "," and depth == 0:
            found.append("")
        else:
            found[-1] += each
    return tuple(part for part in map(str.strip, found) if part)


def _unit_of(tree: ast.expr) -> str:
    """The unit of a reduction of a channel; ParameterError for anything else."""
    if isinstance(tree, ast.Call) and name_of(tree.func) in REDUCTIONS and len(tree.args) == 1:
        name = name_of(tree.args[0])
        if name in frame.channels():
            return frame.units()[name]
    raise ParameterError(f"its unit is missing, expected {FORM}")


def _needs(tree: ast.expr) -> Iterator[str]:
    for node in ast.walk(tree):
        name = name_of(node) if isinstance(node, ast.expr) else None
        if name in frame.channels():
            yield name
        elif name in SERIES:
            yield from SERIES[name].needs
        elif name in METRICS:
            yield from METRICS[name].needs
