"""How well real time was kept, in words."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any


def quantile(histogram: Mapping[str, Any], share: float) -> float:
    """A time [s] that at least this share of the counted ones is not above: the upper end of a bin, or the largest."""
    due, seen = share * sum(histogram["counts"]), 0
    for count, end in zip(histogram["counts"], histogram["edges"], strict=False):
        seen += count
        if seen >= due:
            return float(min(end, histogram["largest"]))
    return float(histogram["largest"])


def in_words(timing: Mapping[str, Any]) -> str:
    """One line: late steps, lateness, and commands that were missed."""
    late = timing["lateness"]
    middle, most, largest = (1e3 * time for time in (quantile(late, 0.5), quantile(late, 0.99), late["largest"]))
    return (
        f"real time: {timing['overruns']} of {timing['steps']} steps came more than a period late; lateness at most "
        f"{middle:.3g} ms of half of them, {most:.3g} ms of 99 %, {largest:.3g} ms of all; "
        f"{timing['without_command']} steps with less torque since the command was too old"
    )
