"""Curves that a scenario names for the first screen of its page."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.refusal import ParameterError, quoted, unknown_name
from ev_stack.measures.derived import SERIES

DEFAULT = (
    "steering_column.state.angle",
    "imu.yaw_rate",
    "imu.lateral_acceleration",
    "twist.longitudinal",
)
MOST = 4  # that stand beside the car on a screen of 1280 by 800


def refuse_curves(names: Sequence[str]) -> None:
    """ParameterError unless these are up to four different curves."""
    for name in names:
        if name not in _known():
            raise ParameterError(f"curves: {unknown_name('curve', name, _known())}")
        if names.count(name) > 1:
            raise ParameterError(f"curves: {quoted(name)} is there twice, expected once")
    if not 1 <= len(names) <= MOST:
        raise ParameterError(f"curves: {len(names)} names, expected 1 to {MOST}")


@cache
def _known() -> tuple[str, ...]:
    """Fields of topics, each with all of its channels, single channels, and derived series."""
    names = dict.fromkeys(SERIES)
    for topic in TOPICS.values():
        prefix = topic.name.replace("/", ".")
        names |= dict.fromkeys(f"{prefix}.{field}" for field in topic.shape.fields)
        names |= dict.fromkeys(topic.channels)
    return tuple(names)
