"""Time of the elementary functions beside those of the C library, compiled and interpreted, in one run.

    python benchmarks/elementary.py [--only NAME ...] [--json FILE]

The arguments are random, so branches are foreseen as badly as they can be. Both are measured in
alternating rounds, by processor time (`rounds`).
"""

from __future__ import annotations

import argparse
import json
import math
import statistics
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numba import njit
from numba.extending import register_jitable
from rounds import Ratio, alternating, as_json, machine, processor_time, ratio_of

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
class Pair:
    """A function of ours beside that of the C library: times per call [s], round by round.

    Nothing where numba has no such function of the C library.
    """

    ours: list[float]
    library: list[float]

    @property
    def medians(self) -> tuple[float, float | None]:
        """Time per call of either."""
        return statistics.median(self.ours), statistics.median(self.library or [0.0]) or None

    @property
    def ratio(self) -> Ratio | None:
        """Ours over the C library's."""
        return ratio_of(self.ours, self.library) if self.library else None

    @property
    def shown(self) -> str:
        """Columns of the table."""
        ours, library = self.medians
        beside = f"{library * 1e9:.1f}" if library else "-"
        return f"{ours * 1e9:>10.1f}{beside:>8}  {self.ratio or '-'!s:<22}"

    @property
    def entries(self) -> dict[str, Any]:
        """Entries of the file."""
        ours, library = self.medians
        return {"seconds": ours, "library": library, **(as_json(self.ratio) if self.ratio else {})}


@dataclass(frozen=True)
class Row:
    """One line of the table."""

    name: str
    low: float
    high: float
    compiled: Pair
    python: Pair


def pair(repeats: int, ours: Callable[[], Any], library: Callable[[], Any] | None) -> Pair:
    """Measure calls that take all arguments."""
    measures = {"ours": partial(processor_time, ours)}
    if library is not None:
        measures["library"] = partial(processor_time, library)
    found = alternating(measures, repeats)
    per_call = {name: [seconds / COUNT for seconds in row] for name, row in found.items()}
    return Pair(per_call["ours"], per_call.get("library", []))


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
            compiled = pair(
                repeats, partial(fast, x, y), fast_library and partial(fast_library, x, y)
            )
            python = pair(
                slow_repeats,
                partial(interpreted_loop, ours, *lists),
                partial(interpreted_loop, library, *lists),
            )
            yield Row(name, low, high, compiled, python)


def main() -> None:
    """Print the table and, if asked for, write it as JSON."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--json", type=Path, help="write the table to this file")
    parser.add_argument(
        "--only", nargs="+", choices=RANGES, default=tuple(RANGES), metavar="NAME", help="functions"
    )
    parser.add_argument("--repeats", type=int, default=60, help="rounds")
    arguments = parser.parse_args()
    head = f"{'':>4}{'ours':>6}{'C':>8}  {'ratio':<22}"
    print(f"{'ns per call':<12}{'arguments':>14}  compiled{head}  Python{head}")
    table = []
    for row in rows(arguments.only, arguments.repeats):
        limits = f"{row.low:g} .. {row.high:g}"
        print(f"{row.name:<12}{limits:>18}{row.compiled.shown}{row.python.shown}", flush=True)
        where = {"name": row.name, "low": row.low, "high": row.high}
        table.append({**where, "compiled": row.compiled.entries, "Python": row.python.entries})
    if arguments.json:
        document = {**machine(), "seconds per": "call", "rows": table}
        arguments.json.write_text(json.dumps(document, indent=2) + "\n")


if __name__ == "__main__":
    main()
