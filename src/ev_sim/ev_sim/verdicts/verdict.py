"""The verdict on one id."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ev_sim.measures.metric import FROM_INPUTS, NOT_MEASURED, NOT_REPRODUCED, REPRODUCED, Metric
from ev_sim.verdicts.declaration import Declaration
from ev_sim.verdicts.sources import Published

# The sorts of verdicts, by the words with which their texts begin.
WITH_ASSUMPTION = "reproduced with assumption"
SORTS = (WITH_ASSUMPTION, REPRODUCED, NOT_REPRODUCED, FROM_INPUTS, "not judgeable", "no verdict", NOT_MEASURED)


def sort_of(text: str) -> str:
    """The sort of a verdict from its text."""
    return next(sort for sort in SORTS if text.startswith(sort))


@dataclass(frozen=True)
class Verdict:
    """What was published, what came out, and what that is worth."""

    published: Published
    declaration: Declaration
    metrics: Mapping[str, Metric]
    tolerances: Mapping[str, str]

    @property
    def judgement(self) -> str:
        """The verdict without its reason or assumption; an id with several numbers holds if all of them hold."""
        if self.declaration.unjudged:
            return self.declaration.unjudged.partition(":")[0]
        each = {metric.judgement for metric in self.metrics.values() if metric.reference}
        for worst in (NOT_MEASURED, NOT_REPRODUCED):
            if worst in each:
                return worst
        return FROM_INPUTS if self.declaration.inputs else REPRODUCED

    @property
    def assumption(self) -> str:
        """What had to be added to the source, empty if nothing."""
        first = next(iter(self.metrics.values()), None)
        return first.reference.assumption if first and first.reference else ""

    @property
    def text(self) -> str:
        """The verdict in one line, with its reason or assumption."""
        judgement = self.judgement
        if self.declaration.unjudged:
            return self.declaration.unjudged
        if judgement == NOT_MEASURED:
            return f"{judgement}: " + "; ".join(metric.reason for metric in self.metrics.values() if metric.reason)
        if judgement == FROM_INPUTS:
            return f"{judgement}: {self.declaration.inputs}"
        if judgement == REPRODUCED and self.assumption:
            return f"{judgement} with assumption {self.assumption}"
        return judgement

    @property
    def ours(self) -> str:
        """The numbers that came out, with their units."""
        parts = []
        for check in self.declaration.checks:
            metric = self.metrics[check.name]
            number = NOT_MEASURED if metric.value is None else check.text(metric.value)
            parts.append(f"{check.name} {number}".strip())
        return "; ".join(parts)

    @property
    def tolerance(self) -> str:
        """Tolerance and reason of each number, equal ones once."""
        return "; ".join(dict.fromkeys(self.tolerances.values()))

    @property
    def run(self) -> str:
        """What was driven for it."""
        return "; ".join(need.command for need in self.declaration.needs) or (
            "" if self.declaration.unjudged else "closed form"
        )

    def as_json(self) -> dict[str, Any]:
        """The entry of verdicts.json."""
        return {
            "id": self.published.id,
            "kind": self.published.kind,
            "what": self.published.quantity,
            "printed": self.published.printed,
            "ours": self.ours,
            "values": {name: metric.as_json() for name, metric in self.metrics.items()},
            "tolerance": self.tolerance,
            "verdict": self.text,
            "assumption": self.assumption,
            "run": self.run,
        }


def verdict(of: Published, declaration: Declaration, driven: Sequence[Any]) -> Verdict:
    """The verdict on an id; `driven` are the results of its needs, in their order."""
    metrics = declaration.metrics(of, driven)
    given = tuple(driven)
    tolerances = {check.name: check.tolerance_for(given).text(check.judged_unit) for check in declaration.checks}
    return Verdict(of, declaration, metrics, tolerances)
