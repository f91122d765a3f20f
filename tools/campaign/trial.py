"""One trial: how a run is started, what happens to it, and what may come of it. A kind of fault fills it in."""

from __future__ import annotations

import random
from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from threading import Lock
from typing import TYPE_CHECKING

from ev_msgs_py.contract.fields import SignalError
from ev_msgs_py.refusal import ParameterError
from ev_stack.command_line.options import arguments, overrides
from ev_stack.recording.offline import run_offline
from ev_stack.recording.recording import signal_hash
from ev_stack.running.steering_angles import with_own_angles
from ev_stack.scenarios.records import Run
from ev_stack.scenarios.scenario import load_scenario

if TYPE_CHECKING:
    from campaign.under_way import UnderWay

WAYS = {
    "processes": (),
    "in one process": ("--in-process",),
    "real time": ("--realtime",),
    "offline": ("--offline",),
}
SCENARIOS = ("shchur2019", "double_lane_change", "coast_down", "bench_fault")
DURATIONS = (0.5, 1.0, 2.0)  # s
RUNNER = "runner"
# trials are driven by threads, and the scenarios' modules are loaded by the first one
_LOCK = Lock()


class Skipped(Exception):
    """The system does not grant what this fault needs; the text says what."""


@dataclass
class Trial:
    """What a seed makes, before its kind of fault has filled it in, and after.

    `words` are those of scripts/run.sh, `before` what stands in front of them. `disturb` is called
    when the run has begun. `names` is what the line of a safe stop must say, as a regular
    expression. A run that comes to its end must have the signals of the same words offline, in real
    time signals that are finite.
    """

    seed: int
    kind: str
    way: str
    scenario: str
    duration: float
    folder: Path
    chance: random.Random
    words: list[str] = field(default_factory=list)
    before: list[str] = field(default_factory=list)
    environment: dict[str, str] = field(default_factory=dict)
    limits: dict[int, int] = field(default_factory=dict)  # of resources of the process
    disturb: Callable[[UnderWay], None] = lambda run: None
    names: str = ""
    from_the_start: bool = False  # whether the fault is there before anything strikes
    must_end: bool = False  # whether what strikes ends the run, so that its end must come soon
    # whether another node has the name of one of ours, so that its messages may be taken
    has_twin: bool = False
    turn: int = 0  # how many trials of this kind have lower seeds
    about: str = ""
    clean_up: ExitStack = field(default_factory=ExitStack)

    @property
    def out(self) -> Path:
        """The output folder of the run."""
        return self.folder / "out"

    @property
    def run(self) -> Run:
        """The run that the words mean; ParameterError if they are refused."""
        given = arguments(self.words)
        with _LOCK:
            return with_own_angles(load_scenario(given.scenario, overrides(given))).runs[0]

    def roles(self) -> list[str]:
        """Who takes part, the recorder included."""
        return [*self.run.configurations, "recorder"]

    def expected(self) -> str:
        """The hash of the same words offline, or how they are refused."""
        return _offline(
            tuple(word for word in self.words if word not in ("--in-process", "--offline"))
        )


@lru_cache(maxsize=200)
def _offline(words: tuple[str, ...]) -> str:
    given = arguments(list(words))
    try:
        with _LOCK:
            run = with_own_angles(load_scenario(given.scenario, overrides(given))).runs[0]
            return signal_hash(run_offline(run.configurations, run.duration))
    except (ParameterError, SignalError, OSError) as error:
        return f"refused: {error}"


def begun(seed: int, kind: str, ways: tuple[str, ...], folder: Path) -> Trial:
    """A trial of this kind, without a fault yet."""
    chance = random.Random(f"{seed} {kind}")
    way, scenario, duration = (
        chance.choice(ways),
        chance.choice(SCENARIOS),
        chance.choice(DURATIONS),
    )
    trial = Trial(seed, kind, way, scenario, duration, folder, chance)
    trial.words = [scenario, "--duration", str(duration), *WAYS[way], "--no-report"]
    # else it is driven before anything strikes
    if way in ("processes", "in one process") and chance.random() < 0.6:
        trial.words += ["--set", "plant.real_time_factor=1"]
    return trial
