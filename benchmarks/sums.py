"""What it costs that nodes add up what they take and say: the same run with sums and without, in turn.

    source scripts/setup.sh && python benchmarks/sums.py [--scenario NAME] [--seconds S] [--rounds N] [--in-process]

Printed are steps per second, the best and the median of each, and the ratio with sums over without:
of the best, and of the two runs of each round the median with its quartiles.
"""

from __future__ import annotations

import argparse
import secrets
import statistics
import tempfile
from pathlib import Path
from types import SimpleNamespace
from unittest import mock

import numpy as np

from ev_stack.running import node_reports
from ev_stack.running.processes import run_in_process, run_in_processes
from ev_stack.scenarios.records import Overrides, Run
from ev_stack.scenarios.scenario import load_scenario


def rate(run: Run, sums: bool, in_process: bool) -> float:
    """Steps per second of wall time; nodes without a key have no sums."""
    of_key = SimpleNamespace(token_bytes=secrets.token_bytes if sums else bytes)
    with (
        tempfile.TemporaryDirectory() as folder,
        mock.patch.object(node_reports, "secrets", of_key),
    ):
        outcome = (run_in_process if in_process else run_in_processes)(
            run, Path(folder), False, lambda _: None
        )
    return (len(outcome.recording.time) - 1) / outcome.wall_time


def main() -> None:
    """Print the rates and their ratios."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--scenario", default="shchur2019")
    parser.add_argument("--seconds", type=float, default=100.0, help="of simulated time")
    parser.add_argument("--rounds", type=int, default=15)
    parser.add_argument("--in-process", action="store_true")
    given = parser.parse_args()
    run = load_scenario(given.scenario, Overrides(duration=given.seconds)).runs[0]
    found: dict[bool, list[float]] = {True: [], False: []}
    for n in range(given.rounds):
        for sums in (n % 2 == 0, n % 2 == 1):  # neither has always the warmer machine
            found[sums].append(rate(run, sums, given.in_process))
    for sums, rates in found.items():
        print(
            f"{'with' if sums else 'without'} sums: {max(rates):.0f} steps/s, median"
            f" {statistics.median(rates):.0f}"
        )
    ratios = [
        with_sums / without for with_sums, without in zip(found[True], found[False], strict=True)
    ]
    low, middle, high = np.quantile(ratios, (0.25, 0.5, 0.75))
    print(
        f"ratio: {max(found[True]) / max(found[False]):.3f}, of rounds {middle:.3f} ({low:.3f} to"
        f" {high:.3f})"
    )


if __name__ == "__main__":
    main()
