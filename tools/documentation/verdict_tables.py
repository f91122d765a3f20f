"""The table of docs/verdicts.md: what each source published, and the verdicts."""

from __future__ import annotations

from collections.abc import Sequence

from ev_sim.verdicts.all_verdicts import SOURCES
from ev_sim.verdicts.published import published
from ev_sim.verdicts.table import counts, markdown_table
from ev_sim.verdicts.verdict import Verdict


def verdict_tables(verdicts: Sequence[Verdict]) -> str:
    """One table for each source, below how many verdicts of each sort there are."""
    texts = []
    for source in SOURCES:
        of_source = [each for each in verdicts if each.published.id in published(source)]
        if of_source:
            texts.append(f"### {source}\n\n{counts(of_source)}.\n\n{markdown_table(of_source)}")
    return "\n".join(texts)
