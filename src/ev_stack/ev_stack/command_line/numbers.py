"""Numbers on a command line, each with its bounds, as types of argparse."""

from __future__ import annotations

import argparse
import math
from collections.abc import Callable

from ev_msgs_py.refusal import quoted


def whole(low: int, high: int | None = None) -> Callable[[str], int]:
    """Return the type of a whole number from `low` to `high`."""
    expected = (
        f"a whole number from {low} to {high}"
        if high is not None
        else f"a whole number, {low} or more"
    )

    def number(text: str) -> int:
        try:
            value = int(text)
        except ValueError:
            # Below the range: no number is refused by the same line as one that is out of range.
            value = low - 1
        if value < low or (high is not None and value > high):
            raise argparse.ArgumentTypeError(f"{quoted(text)} is refused, expected {expected}")
        return value

    return number


def real(low: float = -math.inf, high: float = math.inf) -> Callable[[str], float]:
    """Return the type of a finite number from `low` to `high`."""
    within = f" from {low:g} to {high:g}" if math.isfinite(low) and math.isfinite(high) else ""
    if math.isfinite(low) and not within:
        within = f", {low:g} or more"

    def number(text: str) -> float:
        try:
            value = float(text)
        except ValueError:
            # The same: NaN is within no range.
            value = math.nan
        if not (math.isfinite(value) and low <= value <= high):
            raise argparse.ArgumentTypeError(
                f"{quoted(text)} is refused, expected a number{within}"
            )
        return value

    return number


PORT = whole(0, 65535)
