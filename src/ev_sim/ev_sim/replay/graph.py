"""The graph that replays a run: one role is played anew, all others play back what was recorded."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from ev_core.lockstep.configuration import Configuration, configure, refuse_unused
from ev_core.methods.register import CommonParameters
from ev_core.nodes.master.real_time import MasterParameters
from ev_core.parameters.values import entries_by_name
from ev_msgs_py.contract import stamps
from ev_msgs_py.contract.roles import MASTER, ROLES
from ev_msgs_py.contract.signals import Instant
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.refusal import ParameterError, unknown_name
from ev_sim.replay.recorded import Recorded
from ev_sim.scenarios.about import VEHICLE, vehicle_file
from ev_sim.scenarios.parameter_file import ParameterFile
from ev_sim.scenarios.scenario import Overrides, Run

REPLAYED = "replayed"
_OF_WALL_TIME = ("mode", "scheduling_priority", "lock_memory", "real_time_factor", "duration", "await_recorder")


@dataclass(frozen=True)
class Replay:
    """A role that is played anew: `values` are those of its parameters, `duration` is simulated [s]."""

    recorded: Recorded
    role: str
    values: Mapping[str, Any]
    duration: float
    configuration: Configuration = field(init=False)

    def __post_init__(self) -> None:
        values = dict(self.values)
        extra = None
        if self.role == MASTER:
            values["duration"], extra = self.duration, MasterParameters
        try:
            made = configure(self.role, values, extra)
        except ParameterError as error:
            raise ParameterError(f"{self.role}: {error}") from None
        object.__setattr__(self, "configuration", made)
        _refuse_missing(self.recorded, made)

    @property
    def answers(self) -> tuple[type, ...]:
        """The signals that it writes and that were recorded."""
        return tuple(signal for signal in self.configuration.method.writes if self.recorded.has(signal))

    def run(self, signals: Path) -> Run:
        """The graph, with the recorded signals in a file."""
        configurations = {}
        common = {name: value for name, value in self.values.items() if name in entries_by_name(CommonParameters, "")}
        for role in ROLES:
            if role == self.role:
                configurations[role] = self.configuration
            elif any(map(self.recorded.has, ROLES[role].writes)):
                values = {**common, "method": str(signals)}
                if role == MASTER:
                    values["duration"] = self.duration
                configurations[role] = configure(role, values, MasterParameters if role == MASTER else None)
        if MASTER not in configurations:
            topics = ", ".join(TOPICS[signal].name for signal in ROLES[MASTER].writes)
            raise ParameterError(f"{self.recorded.source} has nothing of the {MASTER}, allowed is any of {topics}")
        return Run(REPLAYED, self.recorded.namespace, configurations, self.duration)


def replay_of(recorded: Recorded, role: str, method: str, overrides: Overrides) -> Replay:
    """A role of a recorded run, with the parameters of that run and what differs; `method` may be empty: as recorded.

    ParameterError, in one line, for a role, method, parameter or car that cannot be, and for a topic that is missing.
    """
    if role not in ROLES:
        raise unknown_name("node", role, ROLES)
    for node, key, _ in overrides.values:
        if node not in ("*", role):
            raise ParameterError(f"{node}.{key} is refused: {node} says what was recorded, allowed is {role}.{key}")
    files = [*_car(recorded, overrides.vehicle), *map(ParameterFile, overrides.files)]
    values: dict[str, Any] = {}
    for file in files:
        values.update(file.values_for(f"{recorded.namespace}/{role}"))
    values.update({key: value for _, key, value in overrides.values})
    _refuse_other_car(files[0], recorded.namespace, role, values)
    if method:
        values["method"] = method
    values.setdefault("control_period", stamps.to_seconds(recorded.period))
    for name in _OF_WALL_TIME:
        values.pop(name, None)
    duration = recorded.duration if overrides.duration is None else overrides.duration
    if not 0.0 < duration <= recorded.duration:
        raise ParameterError(f"duration: {duration!r} is refused, allowed is more than 0 and up to {recorded.duration}")
    replay = Replay(recorded, role, values, duration)
    for _, key, _ in overrides.values:
        refuse_unused(key, [replay.configuration])
    return replay


def _car(recorded: Recorded, vehicle: str | None) -> Sequence[ParameterFile]:
    """The file that names the car; there has to be one."""
    given = recorded.parameters
    if given is not None:
        if vehicle:
            raise ParameterError(f"--vehicle {vehicle} is refused: {given.path} says which car it was")
        return (given,)
    if not vehicle:
        raise ParameterError(f"{recorded.source}: no parameters.yaml beside it says which car it was: --vehicle FILE")
    return (vehicle_file(vehicle),)


def _refuse_other_car(driven: ParameterFile, namespace: str, role: str, values: Mapping[str, Any]) -> None:
    """ParameterError if the car is not that of the file of what was driven."""
    car = driven.values_for(f"{namespace}/{role}")
    for name, value in values.items():
        if name.startswith(f"{VEHICLE}.") and value != car.get(name, value):
            raise ParameterError(f"{name} {value} is refused: {car[name]} was driven ({driven.path})")


def _refuse_missing(recorded: Recorded, configuration: Configuration) -> None:
    role, method = configuration.role, configuration.method
    has = ", ".join(topic.name for topic in recorded.topics)
    for signal in method.inputs:
        if signal is not Instant and not recorded.has(signal):
            reads = f"which the {role} {method.name} reads"
            raise ParameterError(f"{recorded.source} has no {TOPICS[signal].name}, {reads}; it has {has}")
    if not any(map(recorded.has, method.writes)):
        topics = ", ".join(TOPICS[signal].name for signal in method.writes)
        raise ParameterError(f"{recorded.source} has no {topics} of the {role} to compare with; it has {has}")
