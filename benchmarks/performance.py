"""The page of performance: every ratio of the benchmarks, and what runs take of memory.

    source scripts/setup.sh && python benchmarks/performance.py [--only NAME ...] [--page FILE] [--words WORD ...]

Run it on a machine that does nothing else. Each benchmark is its own process, one after the other.
Each of its ratios is that of alternating rounds (`rounds`), so that every number was measured as
often as there are rounds. The page names the machine and the command of each table; a table
that is not measured now stays.
"""

from __future__ import annotations

import argparse
import json
import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from rounds import machine

ROOT = Path(__file__).parents[1]
sys.path.append(str(ROOT / "tools"))

from documentation.markdown import with_blocks  # noqa: E402, which is none of a package

PAGE = ROOT / "docs" / "performance.md"
BENCHMARKS = (
    "plant",
    "urban_cycle",
    "batch",
    "vector",
    "native",
    "bench",
    "lockstep",
)
_OFFLINE = ("--offline", "--no-record", "--no-report")
# Each twice, the second time with ten times the work: what grows is seen.
MEMORY = {
    "a run of 10 s": ("ev-stack", "run", "double_lane_change", *_OFFLINE, "--duration", "10"),
    "a run of 100 s": ("ev-stack", "run", "double_lane_change", *_OFFLINE, "--duration", "100"),
    "a sweep of 1000 runs of 0.1 s": (
        *("ev-stack", "run", "sweep", "shchur2019", "--seeds", "1000"),
        *("--duration", "0.1", "--workers", "1"),
    ),
    "a sweep of 10 000 runs of 0.1 s": (
        *("ev-stack", "run", "sweep", "shchur2019", "--seeds", "10000"),
        *("--duration", "0.1", "--workers", "1"),
    ),
    "a vector of 10 000 cars, 50 steps": (
        *("python", "benchmarks/vector.py", "--memory", "10000", "--steps", "50"),
    ),
    "a vector of 10 000 cars, 500 steps": (
        *("python", "benchmarks/vector.py", "--memory", "10000", "--steps", "500"),
    ),
}


def ratios(found: Any, name: str = "") -> Iterator[tuple[str, dict[str, Any]]]:
    """Entries of all ratios in the document of a benchmark, each with its name."""
    if isinstance(found, list):
        for each in found:
            yield from ratios(each)
    elif isinstance(found, dict) and "spread" in found:
        yield found.get("name", name), found
    elif isinstance(found, dict):
        for key, value in found.items():
            yield from ratios(value, key)


def table_of(benchmark: str, words: Sequence[str]) -> list[str]:
    """Command and table of a benchmark that gets these words, measured now."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "found.json"
        command = [sys.executable, str(ROOT / "benchmarks" / f"{benchmark}.py"), *words]
        subprocess.run([*command, "--json", str(file)], cwd=folder, check=True)
        found = json.loads(file.read_text())
    shown = " ".join([f"benchmarks/{benchmark}.py", *words])
    lines = [f"`{shown}`", "", "|what|ratio|spread|goal|", "|---|---|---|---|"]
    for name, ratio in ratios(found):
        value, goal = ratio["ratio"], ratio["goal"]
        cells = [
            name.replace("_", " "),
            "not reported" if value is None else f"{value:.2f}",
            f"{ratio['spread']:.2f}",
            "" if goal is None else f"{goal:.2f}",
        ]
        lines.append(f"|{'|'.join(cells)}|")
    return lines


def peak_of(words: tuple[str, ...]) -> float:
    """Largest memory of a command that leaves its files in an empty folder [MB]."""
    with tempfile.TemporaryDirectory() as folder:
        out = ("--out", f"{folder}/out") if words[0] == "ev-stack" else ()
        process = subprocess.Popen(
            [*words, *out],
            cwd=ROOT,
            stdout=subprocess.DEVNULL,
            env={**os.environ, "EV_STACK_RESULTS": f"{folder}/results"},
        )
        _, status, used = os.wait4(process.pid, 0)
    if status:
        raise SystemExit(f"{' '.join(words)} ended with status {status}")
    return used.ru_maxrss * 1024 / 1e6


def table_of_memory() -> list[str]:
    """Table of the memory of commands, measured now."""
    lines = ["|what|peak [MB]|command|", "|---|---|---|"]
    for name, words in MEMORY.items():
        lines.append(f"|{name}|{peak_of(words):.0f}|`{' '.join(words)}`|")
    return lines


def main() -> None:
    """Measure, and write the page."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    known = [*BENCHMARKS, "memory"]
    parser.add_argument("--only", nargs="+", choices=known, default=known, metavar="NAME")
    parser.add_argument("--page", type=Path, default=PAGE, help="written anew where it is marked")
    parser.add_argument(
        "--words",
        nargs=argparse.REMAINDER,
        default=[],
        metavar="WORD",
        help="for the benchmarks, as less work",
    )
    given = parser.parse_args()
    text = given.page.read_text()
    for name in BENCHMARKS:
        if name in given.only:
            text = with_blocks(text, {name: "\n".join(table_of(name, given.words))})
    if "memory" in given.only:
        text = with_blocks(text, {"memory": "\n".join(table_of_memory())})
    where = f"{machine()['machine']}, Python {machine()['python']}, {os.cpu_count()} cores"
    text = re.sub(r"(?<=\nMachine of the last measurement: ).*", where, text)
    given.page.write_text(text)


if __name__ == "__main__":
    main()
