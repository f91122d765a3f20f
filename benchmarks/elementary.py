"""Time of the elementary functions beside those of the C library, compiled and interpreted, in one run.

    python benchmarks/elementary.py [--only NAME ...] [--json FILE]

The arguments are random, so branches are foreseen as badly as they can be.
"""

from __future__ import annotations

import argparse
import json
import math
import platform
import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numba import njit
from numba.extending import register_jitable

from ev_core import elementary
from ev_msgs_py.compilable import FUNCTIONS

COUNT = 10_000
# Ranges of the arguments: those of steering angles and slips, of headings, of what a law may get by
# mistake.
RANGES = {
    **dict.fromkeys(("sin", "cos", "tan"), ((-0.7, 0.7), (-3.2, 3.2), (-1e4, 1e4))),
    **dict.fromkeys(("asin", "acos", "atanh"), ((-1.0, 1.0),)),
    "atan": ((-0.4, 0.4), (-3.0, 3.0)),
    "exp": ((-1.0, 1.0), (-300.0, 0.0)),
    **dict.fromkeys(("expm1", "sinh", "cosh", "tanh"), ((-0.5, 0.5), (-5.0, 5.0))),
    **dict.fromkeys(("log", "log1p"), ((0.0, 5.0),)),
    **dict.fromkeys(("atan2", "hypot", "remainder"), ((-1.0, 1.0),)),
}
TWO = ("atan2", "hypot", "remainder")


@dataclass(frozen=True)
class Row:
    """One line of the table: times per call [s]; nothing where numba has no such function of the C library."""

    name: str
    low: float
    high: float
    compiled: float
    compiled_library: float | None
    python: float
    python_library: float

    @property
    def ratios(self) -> tuple[float | None, float]:
        """Ours over the C library's, compiled and interpreted."""
        compiled = self.compiled / self.compiled_library if self.compiled_library else None
        return compiled, self.python / self.python_library


def best_time(repeats: int, call: Callable[..., Any], *arguments: Any) -> float:
    """Shortest time per argument [s]: the other processes of the machine only ever add time."""
    best = math.inf
    call(*arguments)  # compiles
    for _ in range(repeats):
        start = time.perf_counter()
        call(*arguments)
        best = min(best, time.perf_counter() - start)
    return best / COUNT


def compiled_loop(
    function: Callable[..., float], two: bool
) -> Callable[[np.ndarray, np.ndarray], float]:
    """A compiled sum of the function over arrays."""
    if two:

        @njit(error_model="numpy")
        def loop(x: np.ndarray, y: np.ndarray) -> float:
            total = 0.0
            for i in range(x.size):
                total += function(x[i], y[i])
            return total

    else:

        @njit(error_model="numpy")
        def loop(x: np.ndarray, y: np.ndarray) -> float:
            total = 0.0
            for i in range(x.size):
                total += function(x[i])
            return total

    return loop


def interpreted_loop(function: Callable[..., float], *arguments: list[float]) -> None:
    """Call the function for all arguments."""
    for _ in map(function, *arguments):
        pass


def rows(names: Sequence[str], repeats: int) -> Iterator[Row]:
    """Functions over all their ranges."""
    for function in FUNCTIONS:
        register_jitable(error_model="numpy")(function)
    generator = np.random.default_rng(1)
    slow_repeats = max(repeats // 4, 1)
    for name in names:
        ranges = RANGES[name]
        ours, library, two = getattr(elementary, name), getattr(math, name), name in TWO
        fast = compiled_loop(ours, two)
        fast_library = None if name == "remainder" else compiled_loop(library, two)
        for low, high in ranges:
            x, y = generator.uniform(low, high, (2, COUNT))
            lists = (x.tolist(), y.tolist()) if two else (x.tolist(),)
            yield Row(
                name,
                low,
                high,
                best_time(repeats, fast, x, y),
                best_time(repeats, fast_library, x, y) if fast_library else None,
                best_time(slow_repeats, interpreted_loop, ours, *lists),
                best_time(slow_repeats, interpreted_loop, library, *lists),
            )


def main() -> None:
    """Print the table and, if asked for, write it as JSON."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--json", type=Path, help="write the table to this file")
    parser.add_argument(
        "--only", nargs="+", choices=RANGES, default=tuple(RANGES), metavar="NAME", help="functions"
    )
    parser.add_argument("--repeats", type=int, default=60, help="the best of so many counts")
    arguments = parser.parse_args()
    print(
        f"{'ns per call':<12}{'arguments':>18}{'compiled':>10}{'C':>8}{'ratio':>8}{'Python':>10}{'C':>8}{'ratio':>8}"
    )
    table = []
    for row in rows(arguments.only, arguments.repeats):
        compiled, python = row.ratios
        library = f"{row.compiled_library * 1e9:.1f}" if row.compiled_library else "-"
        print(
            f"{row.name:<12}{f'{row.low:g} .. {row.high:g}':>18}"
            f"{row.compiled * 1e9:>10.1f}{library:>8}{f'{compiled:.2f}' if compiled else '-':>8}"
            f"{row.python * 1e9:>10.0f}{row.python_library * 1e9:>8.0f}{python:>8.1f}"
        )
        table.append({**asdict(row), "ratio compiled": compiled, "ratio Python": python})
    if arguments.json:
        machine = platform.processor() or platform.machine()
        document = {
            "machine": machine,
            "python": platform.python_version(),
            "seconds per": "call",
            "rows": table,
        }
        arguments.json.write_text(json.dumps(document, indent=2) + "\n")


if __name__ == "__main__":
    main()
