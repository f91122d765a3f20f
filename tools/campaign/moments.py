"""When a fault strikes: some time after the run has come so far, from the first millisecond on."""

from __future__ import annotations

import random
import time
from collections.abc import Callable
from dataclasses import dataclass

from campaign.under_way import UnderWay
from ev_stack.recording.recording import SIGNALS

START, THERE, ANNOUNCED, MOVING, ENDING = "start", "process", "announced", "moving", "ending"


@dataclass(frozen=True)
class Moment:
    """So many seconds after a phase of the run has begun."""

    phase: str
    delay: float

    def __str__(self) -> str:
        return f"{self.delay * 1000:.0f} ms after {self.phase}"

    def wait(self, run: UnderWay, target: str) -> int | None:
        """Wait for it; the process id of the target, None if the run has ended before."""
        begun: dict[str, Callable[[], bool]] = {
            START: lambda: True,
            THERE: lambda: run.pid_of(target) is not None,
            ANNOUNCED: lambda: run.domain() is not None,
            MOVING: run.is_moving,
            ENDING: lambda: (run.trial.out / SIGNALS).exists(),
        }
        if not run.wait_until(begun[self.phase]):
            return None
        deadline = time.monotonic() + self.delay
        while time.monotonic() < deadline:
            if run.process.poll() is not None:
                return None
            time.sleep(min(0.002, self.delay))
        return (
            run.pid_of(target) if run.wait_until(lambda: run.pid_of(target) is not None) else None
        )


def drawn(chance: random.Random, way: str, duration: float, of_a_node: bool) -> Moment:
    """Any time: the first milliseconds as often as the middle of the run."""
    if of_a_node:
        phase = chance.choice((THERE, THERE, ANNOUNCED, MOVING, MOVING, ENDING))
    elif way == "offline":
        phase = chance.choice((START, START, MOVING, ENDING))
    else:
        phase = chance.choice((START, START, ANNOUNCED, MOVING, MOVING, ENDING))
    if phase == MOVING:
        return Moment(phase, chance.uniform(0.0, duration))
    return Moment(phase, 10 ** chance.uniform(-3.0, 0.0 if phase != ENDING else -0.5))
