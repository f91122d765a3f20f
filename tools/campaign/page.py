"""The table of a campaign."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from statistics import median

from campaign.judging import FAILED, OUTCOMES, SKIPPED, Verdict
from campaign.kinds import KINDS
from documentation.markdown import table


def part_of(first: int) -> str:
    """What the part of a page is called that holds the results from a seed on."""
    return f"results from seed {first}"


def result_text(verdicts: Sequence[Verdict], first: int, asked: int, seconds: float) -> str:
    """What was driven, a row per kind of fault, and a line for each failure."""
    found = Counter(verdict.outcome for verdict in verdicts)
    driven = len(verdicts) - found[SKIPPED]
    head = (
        f"{driven - found[FAILED]} of {driven} trials ended as they should, {found[SKIPPED]}"
        f" skipped, of {asked} asked for; seeds from {first} on, {seconds / 60:.0f} min of wall"
        " time."
    )
    columns = ("fault", *OUTCOMES, "struck", "median [s]", "longest [s]")
    rows = [
        row
        for kind in KINDS
        if (row := _row(kind.name, [v for v in verdicts if v.trial.kind == kind.name]))
    ]
    rows.append(_row("all", list(verdicts)))
    reasons = sorted(
        {f"Skipped, {v.trial.kind}: {v.remark}." for v in verdicts if v.outcome == SKIPPED}
    )
    failures = [
        f"- seed {v.trial.seed}, {v.trial.kind}, {v.trial.way}: {' '.join(v.remark.split())}"
        for v in verdicts
        if v.outcome == FAILED
    ]
    return "\n\n".join(
        part
        for part in (head, table(columns, rows).strip(), "\n".join(reasons), "\n".join(failures))
        if part
    )


def _row(name: str, verdicts: list[Verdict]) -> tuple[str, ...]:
    if not verdicts:
        return ()
    found = Counter(verdict.outcome for verdict in verdicts)
    times = [verdict.seconds for verdict in verdicts if verdict.outcome != SKIPPED] or [0.0]
    return (
        name,
        *(str(found[outcome]) for outcome in OUTCOMES),
        str(sum(verdict.struck for verdict in verdicts)),
        f"{median(times):.1f}",
        f"{max(times):.1f}",
    )
