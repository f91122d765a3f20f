"""The table of docs/signal_hashes.md: the hash of every run of every scenario."""

from __future__ import annotations

import re
from collections.abc import Mapping

from documentation.markdown import code, table
from ev_stack.recording.offline import run_offline
from ev_stack.recording.recording import signal_hash
from ev_stack.scenarios.files import scenario_names
from ev_stack.scenarios.scenario import load_scenario

HASHES = "docs/signal_hashes.md"
_ROW = re.compile(r"^\| `(\w+)` \| `(\w+)` \| `([0-9a-f]+)` \|$", re.MULTILINE)
_DIGITS = 12

# (scenario, run) -> the first digits of the hash of its signals
Hashes = Mapping[tuple[str, str], str]


def published_hashes(page: str) -> dict[tuple[str, str], str]:
    """What the table of a page says."""
    return {(scenario, run): digits for scenario, run, digits in _ROW.findall(page)}


def scenario_hashes(scenario: str) -> dict[tuple[str, str], str]:
    """Those of the runs of a scenario, each driven offline at its full length with default parameters."""
    return {
        (scenario, run.name): signal_hash(run_offline(run.configurations, run.duration))[:_DIGITS]
        for run in load_scenario(scenario).runs
    }


def all_hashes() -> dict[tuple[str, str], str]:
    """Those of all scenarios."""
    return {
        key: digits for name in scenario_names() for key, digits in scenario_hashes(name).items()
    }


def hash_table(hashes: Hashes) -> str:
    """One row per run."""
    return table(
        ("scenario", "run", "hash"), (map(code, (*key, digits)) for key, digits in hashes.items())
    )


def changes(before: Hashes, now: Hashes) -> list[str]:
    """One line for each run whose hash is another one, new or gone."""
    return [
        f"{scenario} / {run}: {before.get((scenario, run), 'new')} ->"
        f" {now.get((scenario, run), 'gone')}"
        for scenario, run in {**before, **now}
        if before.get((scenario, run)) != now.get((scenario, run))
    ]
