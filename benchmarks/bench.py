"""Time of a control period with the test bench in the loop, without and with its CAN bus, beside the virtual run.

    source scripts/setup.sh && chrt -r 5 python benchmarks/bench.py [--repeats N] [--json FILE]

The first 24 s of the urban cycle, offline, period 5 ms: the whole graph in one compiled loop,
recording included. All rows are measured in alternating rounds, by processor time (`rounds`), so
that their ratios hold on a busy machine.
"""

from __future__ import annotations

import argparse
import json
import statistics
from functools import partial
from pathlib import Path

from rounds import alternating, as_json, machine, processor_time, ratio_of

from ev_core.lockstep.run import GraphRun
from ev_msgs_py.contract import stamps
from ev_stack.scenarios.records import Overrides, Run
from ev_stack.scenarios.scenario import load_scenario

DURATION = 24.0  # [s]
VIRTUAL = "virtual run"
ROWS = {
    VIRTUAL: ("urban_mixed", ()),
    "with the test bench": ("urban_mixed_bench", ()),
    "with the test bench behind its CAN bus": (
        "urban_mixed_bench",
        (("test_bench", "method", "circuits_on_can"),),
    ),
}


def run_of(scenario: str, values: tuple[tuple[str, str, str], ...]) -> Run:
    """A run of a scenario with other values."""
    (run,) = load_scenario(scenario, Overrides(values=values, duration=DURATION)).runs
    return run


def seconds_per_period(run: Run) -> float:
    """Processor time of one control period, after everything was made."""
    periods = stamps.from_seconds(DURATION) // run.period
    graph = GraphRun(run.configurations, periods + 1)
    return processor_time(lambda: graph.drive(lambda time: None, lambda role, text: None)) / periods


def main() -> None:
    """Print the table and, if asked for, write it as JSON."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--json", type=Path, help="write the table to this file")
    parser.add_argument("--repeats", type=int, default=15, help="rounds")
    arguments = parser.parse_args()
    runs = {name: run_of(*row) for name, row in ROWS.items()}
    measures = {name: partial(seconds_per_period, run) for name, run in runs.items()}
    seconds = alternating(measures, arguments.repeats)
    ratios = {name: ratio_of(row, seconds[VIRTUAL]) for name, row in seconds.items()}
    print(f"{'per control period of 5 ms':<44}{'us':>8}  times virtual")
    for name, row in seconds.items():
        print(f"{name:<44}{statistics.median(row) * 1e6:>8.2f}  {ratios[name]}")
    if arguments.json:
        rows = [
            {"name": name, "seconds": statistics.median(row), **as_json(ratios[name])}
            for name, row in seconds.items()
        ]
        arguments.json.write_text(json.dumps({**machine(), "rows": rows}, indent=2) + "\n")


if __name__ == "__main__":
    main()
