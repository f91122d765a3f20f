"""A replay of a run: one role is played again, all others play back their recorded outputs.

How it works: the recorded signals are saved as signals.npz, and every role but one gets that file
as its method, so it plays back what was recorded. The one role is configured as in the recorded
run, with what the command changes. The graph then runs as any other, offline or, with a program in
the role, as processes.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from ev_core.lockstep.configuration import Configuration, configure, refuse_unused
from ev_core.methods.common_parameters import CommonParameters
from ev_core.parameters.declaration import flatten
from ev_core.parameters.values import entries_by_name
from ev_msgs_py.contract import frame, stamps
from ev_msgs_py.contract.roles import MASTER, ROLES, RoleKind
from ev_msgs_py.contract.signals import Instant
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.refusal import ParameterError, unknown_name
from ev_nodes.master.real_time import MasterParameters
from ev_stack.figures.saving import Print, save_figures
from ev_stack.figures.sheets import drawn
from ev_stack.recording.outcome import Outcome
from ev_stack.recording.recording import (
    PAGE,
    PARAMETERS,
    SIGNALS,
    SUMMARY,
    Recording,
    atomic_file,
    save,
)
from ev_stack.report.summary import Summary, write_summary
from ev_stack.running.offline import write_parameter_file
from ev_stack.scenarios.files import VEHICLE, vehicle_file
from ev_stack.scenarios.parameter_file import ParameterFile
from ev_stack.scenarios.records import Overrides, Run
from ev_stack.scenarios.sources import Sources
from ev_study.replay import comparing
from ev_study.replay.comparing import Difference, difference_of
from ev_study.replay.recorded import Recorded

_RECORDED, REPLAYED, _LATENCY = "recorded", "replayed", "latency"
# How the recorded run kept to the time of the world, which a replay does not.
_OF_WALL_TIME = (
    "mode",
    "scheduling_priority",
    "lock_memory",
    "real_time_factor",
    "duration",
    "await_recorder",
)


@dataclass(frozen=True)
class Replay:
    """A role that is played again: `values` are its parameters, `duration` is simulated [s]."""

    recorded: Recorded
    role: str
    values: Mapping[str, Any]
    duration: float
    configuration: Configuration

    @property
    def answers(self) -> tuple[type, ...]:
        """The signals that it writes and that were recorded."""
        return tuple(
            signal for signal in self.configuration.method.writes if self.recorded.has(signal)
        )

    def run(self, signals: Path) -> Run:
        """The graph, with the recorded signals in a file."""
        configurations = {}
        # The car, the period and the seed, which all roles share; the rest of the values is of the
        # replayed role.
        common = {
            name: value
            for name, value in self.values.items()
            if name in entries_by_name(CommonParameters, "")
        }
        for role in ROLES:
            # Roles of which nothing was recorded are left out: nothing of the replayed role reads
            # them.
            if role == self.role:
                configurations[role] = self.configuration
            elif any(map(self.recorded.has, ROLES[role].writes)):
                values = {**common, "method": str(signals)}
                values, extra = _with_duration(role, values, self.duration)
                configurations[role] = configure(role, values, extra)
        # Without it nothing counts the instants.
        if MASTER not in configurations:
            topics = ", ".join(TOPICS[signal].name for signal in ROLES[MASTER].writes)
            raise ParameterError(
                f"{self.recorded.source} has nothing of the {MASTER}, expected any of {topics}"
            )
        return Run(REPLAYED, self.recorded.namespace, configurations, self.duration)

    def differences(self, replayed: Recording) -> tuple[Difference, ...]:
        """All channels that the role writes and that were recorded, where both sides are known."""
        came, units = self.recorded.came, frame.units()
        # A replay may be shorter than the record (--duration).
        known = self._compared()[: len(replayed.time)]
        return tuple(
            difference_of(
                name, units[name], self.recorded.recording.channels[name], replayed, known & there
            )
            for signal in self.answers
            for there in [came[TOPICS[signal]][: len(known)]]
            for name in TOPICS[signal].channels
        )

    def _compared(self) -> np.ndarray:
        """Mask of instants with the role's inputs, (n,): the one before if it integrates."""
        there = np.ones(len(self.recorded.recording.time), bool)
        for signal in self.configuration.method.reads:
            if signal is not Instant:
                there &= self.recorded.came[TOPICS[signal]]
        return (
            # Its first state follows from no input.
            np.append([True], there[:-1]) if ROLES[self.role].kind is RoleKind.INTEGRATES else there
        )


def _with_duration(
    role: str, values: Mapping[str, Any], duration: float
) -> tuple[Mapping[str, Any], type | None]:
    """Values of a role, and what else it has: the master has the duration besides."""
    if role == MASTER:
        return {**values, "duration": duration}, MasterParameters
    return values, None


def replay_of(recorded: Recorded, role: str, method: str, overrides: Overrides) -> Replay:
    """A role of a recorded run, with the parameters of that run and what differs.

    `method` may be empty: as recorded.

    ParameterError, in one line, for a role, method, parameter or car that cannot be, and for a
    topic that is missing.
    """
    if role not in ROLES:
        raise unknown_name("node", role, ROLES)
    for node, key, _ in overrides.values:
        if node not in ("*", role):
            raise ParameterError(
                f"{node}.{key} is refused: {node} says what was recorded, expected {role}.{key}"
            )
    _refuse_other_namespace(recorded, role)
    files = [*_car(recorded, overrides.vehicle), *map(ParameterFile, overrides.files)]
    sources = Sources(recorded.namespace, files, overrides)
    values = sources.values(role)
    _refuse_other_car(files[0], recorded.namespace, role, values)
    if method:
        values["method"] = method
    # A bag without parameters.yaml still shows its period by its stamps.
    values.setdefault("control_period", stamps.to_seconds(recorded.period))
    for name in _OF_WALL_TIME:
        values.pop(name, None)
    duration = recorded.duration if overrides.duration is None else overrides.duration
    if not 0.0 < duration <= recorded.duration:
        raise ParameterError(
            f"duration: {duration!r} is refused, expected more than 0 and up to {recorded.duration}"
        )
    configuration = sources.configured(role, *_with_duration(role, values, duration))
    _refuse_missing(recorded, configuration)
    _refuse_not_finite(recorded, configuration)
    refuse_unused([key for _, key, _ in overrides.values], [configuration])
    return Replay(recorded, role, values, duration, configuration)


def _refuse_other_namespace(recorded: Recorded, role: str) -> None:
    """ParameterError if the parameters beside a bag are those of nodes in another namespace.

    Else the role would be played by its default method with its default parameters.
    """
    given, node = recorded.parameters, f"{recorded.namespace}/{role}"
    if given is None or given.values_for(node):
        return
    sections = [name for name in given.sections if name.endswith(f"/{role}")]
    if sections:
        raise ParameterError(
            f"{given.path} has parameters for {', '.join(sections)}, expected for {node}, as the"
            f" topics of {recorded.source} are named"
        )


def _car(recorded: Recorded, vehicle: str | None) -> Sequence[ParameterFile]:
    """The file that names the car; there has to be one."""
    given = recorded.parameters
    if given is not None:
        # The car of the run is known: another one would answer other numbers to the same inputs.
        if vehicle:
            raise ParameterError(
                f"--vehicle {vehicle} is refused: {given.path} says which car it was"
            )
        return (given,)
    if not vehicle:
        raise ParameterError(
            f"{recorded.source}: no parameters.yaml beside it says which car it was: --vehicle FILE"
        )
    return (vehicle_file(vehicle),)


def _refuse_other_car(
    driven: ParameterFile, namespace: str, role: str, values: Mapping[str, Any]
) -> None:
    """ParameterError if the car is not that of the file of what was driven."""
    # Against what is on file for the node; what it leaves out is a default of both.
    car = driven.values_for(f"{namespace}/{role}")
    for name, value in values.items():
        if name.startswith(f"{VEHICLE}.") and value != car.get(name, value):
            raise ParameterError(
                f"{name} {value} is refused: {car[name]} was driven ({driven.path})"
            )


def _refuse_not_finite(recorded: Recorded, configuration: Configuration) -> None:
    """Refuse a recorded answer that is no number: no difference from it has a meaning."""
    for signal in filter(recorded.has, configuration.method.writes):
        for name in TOPICS[signal].channels:
            values = recorded.recording.channels[name]
            # The first of them is enough for a message.
            for place in np.flatnonzero(~np.isfinite(values))[:1]:
                at = f"{name} at {recorded.recording.time[place]:g} s"
                raise ParameterError(
                    f"{recorded.source}: {at} is {values[place]}, expected a finite number"
                )


def _refuse_missing(recorded: Recorded, configuration: Configuration) -> None:
    role, method = configuration.role, configuration.method
    has = ", ".join(topic.name for topic in recorded.topics)
    for signal in method.inputs:
        if signal is not Instant and not recorded.has(signal):
            reads = f"which the {role} {method.name} reads"
            raise ParameterError(
                f"{recorded.source} has no {TOPICS[signal].name}, {reads}; it has {has}"
            )
    if not any(map(recorded.has, method.writes)):
        topics = ", ".join(TOPICS[signal].name for signal in method.writes)
        raise ParameterError(
            f"{recorded.source} has no {topics} of the {role} to compare with; it has {has}"
        )


def prepared(replay: Replay, folder: Path) -> Run:
    """The graph that replays; the recorded signals that it plays back are in the folder then."""
    recorded = folder / _RECORDED
    recorded.mkdir()
    # Both halves of the output are folders of runs, so either can be replayed again.
    (folder / REPLAYED).mkdir()
    _write_told(recorded / PARAMETERS, replay)
    save(replay.recorded.recording, recorded / SIGNALS)
    return replay.run(recorded / SIGNALS)


def _write_told(path: Path, replay: Replay) -> None:
    """Write the known parameters of the recorded run, so that it can be replayed from there."""
    given = replay.recorded.parameters
    if given is not None:
        with atomic_file(path) as file:
            file.write(given.path.read_bytes())
        return
    common = flatten(replay.configuration.common)
    # ROS has no type for an empty list.
    nodes = {"**": {name: value for name, value in common.items() if value != ()}}
    write_parameter_file(
        path, Run(_RECORDED, replay.recorded.namespace, {}, replay.duration), nodes
    )


@dataclass(frozen=True)
class Replayed:
    """A replay that was driven.

    `command` are the words of the node that took part, `line` repeats it all.
    """

    replay: Replay
    run: Run
    outcome: Outcome
    differences: Sequence[Difference]
    command: Sequence[str]
    line: str

    @property
    def _who(self) -> str:
        return " ".join(self.command) or self.replay.configuration.method.name

    @cached_property
    def _latency(self) -> dict[str, Any]:
        return comparing.latency_of(self.replay.recorded)

    @property
    def _notes(self) -> tuple[str, ...]:
        writes, answers = self.replay.configuration.method.writes, self.replay.answers
        # A bag of a part of the topics.
        left_out = [TOPICS[signal].name for signal in writes if signal not in answers]
        more = (f"not in the bag, so not compared: {', '.join(left_out)}",) if left_out else ()
        return (*self.replay.recorded.notes, *more, *self.outcome.notes)

    def lines(self) -> list[str]:
        """Lines for the terminal."""
        table = comparing.table_of(self.differences)
        answers = [TOPICS[signal].name for signal in self.replay.answers]
        return [
            *([table] if table else []),
            *(f"note: {note}" for note in self._notes),
            *(comparing.latencies_in_words(self._latency, answers) if self._latency else []),
            f"{self.replay.role} {self._who}: {comparing.in_words(self.differences)}",
            f"{self.run.duration:g} s in {self.outcome.wall_time:.2f} s",
        ]

    def write(self, folder: Path, page: bool, prints: Print) -> str:
        """Write all of it; the answer names the page if there is one."""
        runs = {_RECORDED: self._recorded(), REPLAYED: self.outcome.recording}
        comparing.table_files(self.differences, folder)
        content = self._content(runs)
        sheets = {_LATENCY: comparing.latency_sheet(self._latency)} if self._latency else {}
        prints.save(sheets, folder)
        write_summary(folder / SUMMARY, content)
        if not page:
            return ""
        figures = drawn(sheets)
        save_figures(figures, folder)
        from ev_stack.report.page.writing import Page, Signals, images_of, write_page

        signals = Signals("", runs, self.replay.configuration.common.vehicle)
        text = "\n".join(
            line
            for line in (comparing.in_words(self.differences), comparing.table_of(self.differences))
            if line
        )
        title = f"{self.replay.role} {self._who}, replayed"
        images = images_of(figures, folder)
        write_page(Page(title, {"": content}, (signals,), images, text), folder / PAGE)
        return f"{PAGE}, "

    def _recorded(self) -> Recording:
        """The part of the recorded run that was replayed."""
        recording, count = self.replay.recorded.recording, len(self.outcome.recording.time)
        return Recording(
            recording.time[:count], {name: row[:count] for name, row in recording.channels.items()}
        )

    def _content(self, runs: dict[str, Recording]) -> dict[str, Any]:
        role, configuration = self.replay.role, self.replay.configuration
        summary = Summary(
            scenario=f"replay of {self.replay.recorded.source}",
            mode="replay, processes" if self.command else "replay, offline",
            seed=configuration.common.seed,
            methods={role: configuration.method.name},
            own_nodes={role: " ".join(self.command)} if self.command else {},
            parameters={role: configuration.values()},
            vehicle=configuration.common.vehicle,
            runs=runs,
            metrics={},
            wall_time=self.outcome.wall_time,
            not_reproducible=self.outcome.not_reproducible,
            notes=self._notes,
            about=f"{role} {self._who} on recorded inputs; all others say what was recorded",
            command=self.line,
            timing={_RECORDED: self._latency} if self._latency else {},
        ).as_json()
        del summary["differs"]  # from a scenario's file, which there is none of
        return {**summary, "differences": [asdict(each) for each in self.differences]}
