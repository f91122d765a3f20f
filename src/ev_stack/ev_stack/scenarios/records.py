"""Records around the resolver: the `Overrides` that it takes, the `Scenario` that it gives."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from ev_core.lockstep.configuration import Configuration
from ev_msgs_py.contract.roles import MASTER
from ev_sim.profiles.profile import cycle_values
from ev_stack.measures.course import NO_COURSE, Course
from ev_stack.scenarios.about import ScenarioParameters
from ev_stack.scenarios.slow_ramp import SlowRampParameters


@dataclass(frozen=True)
class Overrides:
    """Changes beyond the scenario's own files; of several for one parameter the last one counts.

    `values`: (node, dotted parameter name, value). Node `*` means every role. A method that is
    driven must have each of them; those that are `prepared`, which come before, may be for other
    methods, like those of files. `vehicle` is another car than that of the scenario, as a name or a
    path; what the scenario itself changes about the car of all runs is left out then, what it
    changes about that of some runs stays. `metrics` are measured besides its own.
    """

    files: Sequence[Path] = ()
    values: Sequence[tuple[str, str, Any]] = ()
    duration: float | None = None
    vehicle: str | None = None
    prepared: Sequence[tuple[str, str, Any]] = ()
    metrics: Sequence[str] = ()

    def with_seed(self, seed: int | None) -> Overrides:
        """The same with a seed of everything random, if there is one."""
        if seed is None:
            return self
        # Behind all values: the last one counts, so this is the seed of every node.
        return replace(self, values=(*self.values, ("*", "seed", seed)))

    def with_cycle(self, cycle: str | None) -> Overrides:
        """The same with a speed cycle, if there is one; its duration counts where none is given."""
        if cycle is None:
            return self
        prepared, length = cycle_values(cycle)
        duration = length if self.duration is None else self.duration
        return replace(self, prepared=(*self.prepared, *prepared), duration=duration)

    @property
    def all_values(self) -> tuple[tuple[str, str, Any], ...]:
        """Values that are prepared, and those that go before them."""
        return (*self.prepared, *self.values)


@dataclass(frozen=True)
class Run:
    """One configured graph, the namespace of its nodes, and what measures it.

    With a `slow_ramp` its steering angles are still those of another car: the ramp has to be driven
    before it, by `ev_stack.running.steering_angles`.
    """

    name: str
    namespace: str
    configurations: Mapping[str, Configuration]
    duration: float
    report: str = ""
    metrics: tuple[str, ...] = ()
    course: Course = NO_COURSE
    slow_ramp: SlowRampParameters | None = None

    @property
    def period(self) -> int:
        """The control period in nanoseconds."""
        return self.configurations[MASTER].period

    @property
    def realtime(self) -> bool:
        """True if the wall clock drives the graph."""
        return self.configurations[MASTER].common.mode == "realtime"


@dataclass(frozen=True)
class Scenario:
    """A name, its own parameters, its runs, its file, and notes on what of that does not hold.

    `vehicle` is another car than its own, as a name or a path.
    """

    name: str
    parameters: ScenarioParameters
    runs: tuple[Run, ...]
    file: Path
    notes: tuple[str, ...] = ()
    vehicle: str = ""
