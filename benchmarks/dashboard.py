"""What the dashboard costs beside a run: its share of a core, and rows that a page gets, by time and at full speed.

    source scripts/setup.sh && python benchmarks/dashboard.py [--scenario NAME] [--seconds S] [--way WAY ...]

The process of the dashboard is measured with one page open, from two seconds after the first row
on, or from as long as is measured where that is less.
"""

from __future__ import annotations

import argparse
import asyncio
import math
import os
import signal
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from tornado.websocket import websocket_connect

WAYS = {"real_time": "1", "full_speed": "0"}  # and the real-time factor
_TICKS = os.sysconf("SC_CLK_TCK")
_START = 2.0  # s at most after the first row: libraries are loaded, parameters are read


def main() -> None:
    """One line for each way."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("--scenario", default="double_lane_change")
    parser.add_argument(
        "--seconds", type=float, default=5.0, help="of wall time that each way is measured"
    )
    parser.add_argument("--way", nargs="+", choices=WAYS, help="by default both")
    given = parser.parse_args()
    for way in given.way or WAYS:
        factor = WAYS[way]
        share, rows, speed = asyncio.run(measured(given.scenario, factor, given.seconds))
        cost = f"{100 * share:.1f} % of a core, {rows:.1f} rows/s"
        print(
            f"{given.scenario}, {way.replace('_', ' ')}: {cost}, run at {speed:.2f} x real time",
            flush=True,
        )


async def measured(scenario: str, factor: str, seconds: float) -> tuple[float, float, float]:
    """Share of a core, rows per second of a page, and simulated over wall time."""
    program = Path(os.environ["EV_STACK_ROOT"]) / "install/ev_stack/lib/ev_stack/ev-stack"
    with tempfile.TemporaryDirectory() as folder, (Path(folder) / "log").open("wb") as log:
        dashboard = subprocess.Popen(
            [
                *(program, "dashboard", "--port", "0"),
                *(
                    scenario,
                    "--no-record",
                    "--no-report",
                    "--out",
                    f"{folder}/run",
                    "--duration",
                    "1000",
                ),
                *("--set", f"plant.real_time_factor={factor}"),
            ],
            stdout=subprocess.PIPE,
            stderr=log,
            text=True,
        )
        try:
            assert dashboard.stdout is not None
            url = dashboard.stdout.readline().partition("http")[2].strip()
            page = await websocket_connect(f"ws{url}live")
            await rows_within(page, min(_START, seconds))
            used, begin = cpu_time(dashboard.pid), time.monotonic()
            rows, simulated = await rows_within(page, seconds)
            wall = time.monotonic() - begin
            return (cpu_time(dashboard.pid) - used) / wall, rows / wall, simulated / wall
        finally:
            dashboard.send_signal(signal.SIGINT)
            dashboard.communicate()


async def rows_within(page, seconds: float) -> tuple[int, float]:
    """How many rows come in a time from the first one on, and how far simulated time goes."""
    times: list[float] = []
    end = math.inf
    while time.monotonic() < end:
        message = await page.read_message()
        if message is None:
            sys.exit("the run has ended too early")
        if isinstance(message, bytes):
            end = min(end, time.monotonic() + seconds)
            times.append(memoryview(message).cast("d")[0])
    return len(times), times[-1] - times[0]


def cpu_time(process: int) -> float:
    """Seconds that a process has used, all its threads."""
    fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / _TICKS


if __name__ == "__main__":
    main()
