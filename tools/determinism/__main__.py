"""scripts/determinism.sh [--trials N] [--seconds S] [--seed N] [--only SCENARIO ...] [--page FILE]"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

from tqdm import tqdm

from determinism.faults import drawn_changes
from determinism.surroundings import WAYS, Surroundings, drawn
from documentation.markdown import code, table, with_blocks
from ev_stack.recording.offline import run_offline
from ev_stack.recording.recording import signal_hash
from ev_stack.scenarios.files import scenario_names
from ev_stack.scenarios.records import Overrides
from ev_stack.scenarios.scenario import load_scenario

PAGE = "docs/determinism.md"
PART = "results"
_PATIENCE = 600.0  # s for one trial; the first one of a compiler compiles everything


@dataclass
class Found:
    """What the trials of one scenario have shown."""

    scenario: str
    trials: int = 0
    equal: Counter = field(default_factory=Counter)  # by way
    # one line for each trial with another hash, or with none
    others: list[str] = field(default_factory=list)


def main(argv: list[str] | None = None) -> None:
    """Drive every scenario many times in all ways; exit status 1 if any hash differs."""
    parser = argparse.ArgumentParser(
        prog="determinism.sh", description="Look for anything on which bits depend."
    )
    parser.add_argument("--trials", type=int, default=20, help="of each scenario, default 20")
    parser.add_argument(
        "--seconds", type=float, default=3.0, help="simulated time of each trial, default 3"
    )
    parser.add_argument("--seed", type=int, default=1, help="of what is drawn, default 1")
    parser.add_argument(
        "--only", nargs="+", metavar="SCENARIO", choices=scenario_names(), default=scenario_names()
    )
    parser.add_argument("--page", type=Path, help=f"write the table into this page, such as {PAGE}")
    given = parser.parse_args(argv)
    progress = tqdm(
        total=given.trials * len(given.only), unit="trial", disable=not sys.stderr.isatty()
    )
    found = [tried(name, given.trials, given.seconds, given.seed, progress) for name in given.only]
    progress.close()
    text = result_table(found, given.trials, given.seconds, given.seed)
    print(text)
    others = [line for each in found for line in each.others]
    print(*others, sep="\n")
    if given.page:
        given.page.write_text(
            with_blocks(given.page.read_text(encoding="utf-8"), {PART: text}), encoding="utf-8"
        )
    sys.exit(bool(others))


def tried(scenario: str, trials: int, seconds: float, seed: int, progress: tqdm) -> Found:
    """The trials of a scenario, whose runs take turns, each beside the hash of the same run in this process.

    Every other trial has faults and another seed.
    """
    runs = load_scenario(scenario, Overrides(duration=seconds)).runs
    expected = {
        run.name: signal_hash(run_offline(run.configurations, run.duration)) for run in runs
    }
    found = Found(scenario)
    for trial in range(trials):
        # Runs and ways take turns at different rates, so that each run meets each way.
        name = runs[(trial + trial // len(runs)) % len(runs)].name
        surroundings = drawn(trial, seed)
        changes, wanted = (
            drawn_changes(scenario, name, seconds, trial, seed)
            if trial % 2
            else ((), expected[name])
        )
        given = _hash_of((scenario, name, str(seconds), json.dumps(changes)), surroundings)
        found.trials += 1
        if given == wanted:
            found.equal[surroundings.way] += 1
        else:
            found.others.append(
                f"{scenario} {name}, trial {trial}: {given}, not {wanted}: {surroundings},"
                f" {changes}"
            )
        progress.update()
    return found


def _hash_of(words: tuple[str, ...], surroundings: Surroundings) -> str:
    """The hash that a trial prints, or how it failed."""
    command = [sys.executable, "-m", "determinism.trial", *words, surroundings.way]
    environment = {**os.environ, **surroundings.environment}
    with _other_work(os.cpu_count() or 1 if surroundings.busy else 0):
        try:
            done = subprocess.run(
                command, env=environment, capture_output=True, text=True, timeout=_PATIENCE
            )
        except subprocess.TimeoutExpired:
            return f"no end within {_PATIENCE:g} s"
    lines = (done.stdout if done.returncode == 0 else done.stderr).strip().splitlines()
    return lines[-1] if lines else f"status {done.returncode}"


@contextmanager
def _other_work(processes: int) -> Iterator[None]:
    """As many processes that do nothing but compute."""
    busy = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(processes)]
    try:
        yield
    finally:
        for each in busy:
            each.kill()
            each.wait()


def result_table(found: list[Found], trials: int, seconds: float, seed: int) -> str:
    """What was driven, and one row per scenario."""
    rows = [
        (
            code(each.scenario),
            str(each.trials),
            *(str(each.equal[way]) for way in WAYS),
            str(len(each.others)),
        )
        for each in found
    ]
    total = sum(each.trials for each in found)
    equal = sum(each.equal.total() for each in found)
    head = (
        f"{equal} of {total} trials equal: {trials} of each scenario, {seconds:g} s each, seed"
        f" {seed}."
    )
    return f"{head}\n\n{table(('scenario', 'trials', *(f'equal {way}' for way in WAYS), 'others'), rows)}"


if __name__ == "__main__":
    main()
