"""A manoeuvre of a board: what is driven, on which roads, and by which metrics its runs are judged."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from ev_stack.measures import motion
from ev_stack.measures.metric import HIGHER
from ev_stack.measures.named import NamedMetric

ENTRY_SPEED = NamedMetric(
    "entry_speed", "m/s", "speed at the beginning, the highest one that was driven clean",
    lambda run: motion.path_speed(run.signals)[0], ("twist.",), HIGHER,
)  # fmt: skip


@dataclass(frozen=True, slots=True)
class Manoeuvre:
    """A run of a scenario, the roads that it is driven on, and the metrics of each cost.

    `steering_on`: the road on which the steering angles are found on the very car, by the slow ramp
    of the scenario. `entry_speed`: bounds of the speed that is raised until the car is not clean
    any more [m/s], by `halvings`; `speed_scale`: those of the scale of the speed profile of a lap
    [1], likewise. `without`: cars that do not drive it. `demand`: metrics of what the driver asks
    for, such as speed gained, the better the more; the least share of them that a law meets weighs
    all its costs. `recorded` is measured beside them and counts in no cost; without it that of the
    board.
    """

    scenario: str
    duration: float
    roads: list[str]
    handling: list[str]
    energy: list[str]
    run: str = ""
    values: Mapping[str, Any] = field(default_factory=dict)
    steering_on: str = ""
    entry_speed: list[float] = field(default_factory=list)
    speed_scale: list[float] = field(default_factory=list)
    # 64 speeds.
    halvings: int = 6
    demand: list[str] = field(default_factory=list)
    without: list[str] = field(default_factory=list)
    recorded: list[str] = field(default_factory=list)

    def metrics(self, *costs: str) -> list[str | NamedMetric]:
        """Metrics in some costs: names, expressions with lower values better, the entry speed."""
        texts = dict.fromkeys(text for cost in costs for text in getattr(self, cost))
        return [ENTRY_SPEED if text == ENTRY_SPEED.name else text for text in texts]

    @property
    def searched(self) -> list[float]:
        """The bounds of what is raised until the car is not clean any more; empty if nothing is."""
        return self.entry_speed or self.speed_scale

    @property
    def measured(self) -> list[str | NamedMetric]:
        """All that is measured, each once."""
        return list(
            dict.fromkeys(
                (*self.demand, *self.metrics("handling", "energy", "recorded"), "peak_sideslip")
            )
        )
