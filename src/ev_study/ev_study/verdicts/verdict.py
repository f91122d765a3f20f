"""The verdicts on what was published: on one id, on all of them.

As a table, as Markdown and as JSON.

How it works: an id has one or several numbers, each with a judgement of its own. The verdict is the
worst of them, with one exception: "in part" needs a first number that fails and others that all
hold. Its text begins with the words of its sort, by which verdicts are counted, and goes on with
the note: what was assumed belongs to a number that fails as much as to one that holds.
"""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from ev_stack.measures.metric import FROM_INPUTS, NOT_MEASURED, NOT_REPRODUCED, REPRODUCED, Metric
from ev_stack.recording.recording import atomic_file
from ev_stack.report.tables import text_table
from ev_study.verdicts.need import Driven, Need, ScenarioNeed, ScenarioRuns
from ev_study.verdicts.sources import (
    FITTED,
    IN_PART,
    INPUTS,
    NO_VERDICT,
    WITH_ADDITION,
    Published,
    published,
    sources,
)

# The sorts of verdicts, by the words with which their texts begin.
WITH_ASSUMPTION = "reproduced with assumption"
WITH_FIT = "reproduced with a fitted number"
# Longer words before those that they begin with: `sort_of` takes the first that fits.
SORTS = (
    WITH_ASSUMPTION,
    WITH_FIT,
    REPRODUCED,
    IN_PART,
    NOT_REPRODUCED,
    FROM_INPUTS,
    *NO_VERDICT,
    NOT_MEASURED,
)
FIRST = "the first number"  # of an id, which has no name
COLUMNS = ("id", "kind", "what", "printed", "ours", "tolerance", "verdict", "driven")
_SHORT = ("id", "verdict", "ours")


def sort_of(text: str) -> str:
    """The sort of a verdict from its text."""
    return next(sort for sort in SORTS if text.startswith(sort))


@dataclass(frozen=True)
class Verdict:
    """A published number, ours, and their agreement; `note` is its text with ours filled in."""

    published: Published
    metrics: Mapping[str, Metric]
    tolerances: Mapping[str, str]
    note: str

    @property
    def judgement(self) -> str:
        """The verdict without its reason or assumption.

        An id with several numbers holds if all of them hold.
        """
        if not self.published.is_judged:
            return self.published.note
        first, *others = (metric.judgement for metric in self.metrics.values() if metric.reference)
        # The first number is the one as the source defines it: only that may fail for "in part".
        if (
            self.published.note == IN_PART
            and first == NOT_REPRODUCED
            and set(others) == {REPRODUCED}
        ):
            return IN_PART
        # A number that is missing is worse than one that is off: nothing is known of it.
        for worst in (NOT_MEASURED, NOT_REPRODUCED):
            if worst in (first, *others):
                return worst
        # A number that comes from the inputs cannot fail, so it is not called reproduced.
        return FROM_INPUTS if self.published.note == INPUTS else REPRODUCED

    @property
    def assumption(self) -> str:
        """Assumption added to the source, empty if none."""
        return self.note if self.published.note in WITH_ADDITION else ""

    @property
    def _condition(self) -> str:
        """Conditions of ours under which a number fails: which one of several, and the note."""
        judged = {name: metric for name, metric in self.metrics.items() if metric.reference}
        failed = [
            name or FIRST for name, metric in judged.items() if metric.judgement == NOT_REPRODUCED
        ]
        # Where all of them fail their names say nothing.
        named = f"by {'; '.join(failed)}" if len(failed) < len(judged) else ""
        return "; ".join(filter(None, (named, self.note)))

    @property
    def text(self) -> str:
        """The verdict in one line, with its reason or assumption."""
        judgement = self.judgement
        if judgement == NOT_MEASURED:
            return f"{judgement}: " + "; ".join(
                metric.reason for metric in self.metrics.values() if metric.reason
            )
        if judgement in (FROM_INPUTS, IN_PART) or not self.published.is_judged:
            return f"{judgement}: {self.note}"
        if judgement == NOT_REPRODUCED:
            return ": ".join(filter(None, (judgement, self._condition)))
        if self.published.note == FITTED:
            return f"{WITH_FIT}: {self.note}"
        return f"{WITH_ASSUMPTION} {self.note}" if self.assumption else judgement

    @property
    def ours(self) -> str:
        """The numbers that came out, with their units."""
        parts = []
        for check in self.published.checks:
            metric = self.metrics[check.name]
            number = NOT_MEASURED if metric.value is None else check.text(metric.value)
            # The first number of an id has no name.
            parts.append(f"{check.name} {number}".strip())
        return "; ".join(parts)

    @property
    def tolerance(self) -> str:
        """Tolerance and reason of each number, equal ones once."""
        return "; ".join(dict.fromkeys(self.tolerances.values()))

    @property
    def run(self) -> str:
        """Runs that were driven for it."""
        driven = "; ".join(need.command for need in self.published.needs)
        # Without any run the number follows from equations alone.
        return driven or ("closed form" if self.published.is_judged else "")

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


def verdict(of: Published, results: Sequence[Driven]) -> Verdict:
    """The verdict on an id; `results` are those of its needs, in their order."""
    driven = dict(zip(of.needs, results, strict=True))
    tolerances = {
        check.name: check.allowed([driven[need] for need in check.needs]) for check in of.checks
    }
    return Verdict(of, of.metrics(driven), tolerances, of.noted(driven))


def wanted(only: Sequence[str], quick: bool) -> list[tuple[str, Published]]:
    """Published numbers of some sources, with names, or some ids (all if none).

    `quick`: no slow needs.
    """
    return [
        (source, each)
        for source in sources()
        for each in published(source).values()
        if not only
        or any(word in (source, each.id) or each.id.startswith(f"{word}.") for word in only)
        # A need that is slow makes the whole id slow.
        if not (quick and any(need.slow for need in each.needs))
    ]


def metrics_at_hand(source: str, scenario: str, driven: ScenarioRuns) -> dict[str, Metric]:
    """The numbers of all ids that are judged on this scenario as its file has it, for the report on any of its runs.

    A metric bears the name of its id, or ID.CHECK for the further numbers of an id.
    """
    found: dict[str, Metric] = {}
    for id, each in published(source).items():
        at_hand = tuple(
            check for check in each.checks if all(_is_plain(need, scenario) for need in check.needs)
        )
        # An id counts only if all its judged numbers can be measured on this scenario.
        if each.needs and all(check in at_hand for check in each.checks if check.is_judged):
            for name, metric in (
                replace(each, checks=at_hand).metrics(dict.fromkeys(each.needs, driven)).items()
            ):
                found[f"{id}.{name.replace(' ', '_')}" if name else id] = metric
    return found


def _is_plain(need: Need, scenario: str) -> bool:
    return (
        # With other values or another duration it is another run.
        isinstance(need, ScenarioNeed)
        and need.scenario == scenario
        and not (need.values or need.duration)
    )


def plain_table(verdicts: Sequence[Verdict], width: int) -> str:
    """Id, sort of verdict and numbers, cut to `width` characters; the files have the rest."""
    rows = [(each.published.id, sort_of(each.text), each.ours) for each in verdicts]
    return "\n".join(
        line if len(line) <= width else f"{line[: width - 1].rstrip()}…"
        for line in (line.rstrip() for line in text_table(_SHORT, rows, left=_SHORT).splitlines())
    )


def failures(verdicts: Sequence[Verdict]) -> str:
    """The verdicts on what fails, with the conditions under which it does, one line each."""
    failed = [each for each in verdicts if each.judgement == NOT_REPRODUCED]
    return "\n".join(f"{each.published.id}: {each.text}" for each in failed)


def counts(verdicts: Sequence[Verdict]) -> str:
    """Numbers of verdicts of each sort, in one line."""
    found = Counter(sort_of(each.text) for each in verdicts)
    return ", ".join(
        [f"{len(verdicts)} ids", *(f"{found[sort]} {sort}" for sort in SORTS if found[sort])]
    )


def markdown_table(verdicts: Sequence[Verdict]) -> str:
    """Everything about each id, one line each."""
    return (
        "\n".join([_line(COLUMNS), _line(["---"] * len(COLUMNS)), *map(markdown_row, verdicts)])
        + "\n"
    )


def markdown_row(of: Verdict) -> str:
    """The line of one id."""
    what = of.published
    return _line(
        (
            f"`{what.id}`",
            what.kind,
            what.quantity,
            what.printed,
            of.ours,
            of.tolerance,
            of.text,
            of.run,
        )
    )


def write(verdicts: Sequence[Verdict], folder: Path, images: Mapping[str, Sequence[str]]) -> None:
    """Write verdicts.json and verdicts.md.

    `images` are those of scripts/run.sh figures that show an id.
    """
    entries = [
        {**each.as_json(), "figures": list(images.get(each.published.id, ()))} for each in verdicts
    ]
    content = json.dumps(entries, indent=2, allow_nan=False, ensure_ascii=False)
    texts = {"verdicts.json": f"{content}\n", "verdicts.md": markdown_table(verdicts)}
    for name, text in texts.items():
        with atomic_file(folder / name) as file:
            file.write(text.encode())


def _line(cells: Sequence[str]) -> str:
    return "| " + " | ".join(cell.replace("|", r"\|") for cell in cells) + " |"
