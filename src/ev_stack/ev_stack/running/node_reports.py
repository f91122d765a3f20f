"""What a runner sees of the nodes of a run: what each reports on its line, and the graph, by a node of its own."""

from __future__ import annotations

import os
import secrets
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from math import inf
from typing import Any

import numpy as np
import rclpy
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node

from ev_core.lockstep.stepper import WRITERS
from ev_core.lockstep.tally import READ, WRITTEN, Tally
from ev_msgs_py.contract import stamps
from ev_msgs_py.contract.frame import PLACES, SIZE, places
from ev_msgs_py.contract.roles import RECORDER
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.refusal import LINE, shown
from ev_nodes.run_role import NO_LOG_FILE, one_line, refuse_weak_security, security_is_asked_for
from ev_nodes.stepping.runner_line import (
    NOTE,
    PROGRESS,
    TALLY,
    TIME_SERVICE,
    TIMING,
    WAITS,
    WARNING,
    ListeningEnd,
    Word,
)
from ev_nodes.stepping.time_of_day import Alarm, refuse_late_time_of_day
from ev_stack.recording.outcome import Outcome, RunFailed, announce
from ev_stack.recording.recording import Recording


@contextmanager
def observing(namespace: str, domain: int, name: str) -> Iterator[Node]:
    """A node in the graph of a domain; RunFailed where ROS 2 refuses it, as without keys, or fails."""
    refuse_unready()
    context = rclpy.Context()
    try:
        try:
            rclpy.init(
                args=["--ros-args", NO_LOG_FILE, *enclave(name, namespace)],
                context=context,
                domain_id=domain,
            )
            observer = Node(
                name, context=context, namespace=namespace, start_parameter_services=False
            )
        except RuntimeError as error:
            raise RunFailed(one_line(error)) from None
        with Alarm(observer):
            yield observer
        observer.destroy_node()
    except rclpy_implementation.RCLError as error:
        raise RunFailed(one_line(error)) from None
    finally:
        context.try_shutdown()


def refuse_unready() -> None:
    """RunFailed where ROS 2 would leave security away in silence, or could send nothing at this time of day."""
    try:
        refuse_weak_security(os.environ)
        refuse_late_time_of_day()
    except RuntimeError as error:
        raise RunFailed(one_line(error)) from None


def enclave(node: str, namespace: str) -> list[str]:
    """The ROS arguments that name the keys of a process, where security is asked for."""
    return (
        ["--ros-args", "--enclave", f"{namespace}/{node}"]
        if security_is_asked_for(os.environ)
        else []
    )


_BLOCK = 256  # steps
_NAMED = 20  # warnings; more than these are counted only
_WRITER_OF = {TOPICS[signal].name: writer for signal, writer in WRITERS.items()}


class NodeReports:
    """Simulated time, lines for the user, and whether the nodes of the run have taken messages of each other alone."""

    def __init__(self, namespace: str, realtime: bool = False) -> None:
        self.time = 0.0
        self._warnings: dict[str, None] = {}
        self._more_warnings = 0
        # how well real time was kept, as the master reports at its end
        self.timing: dict[str, Any] = {}
        self.rests = False  # whether a service has stopped time
        self._namespace, self._realtime = namespace.rstrip("/"), realtime
        self._key = secrets.token_bytes()
        self._lines: dict[str, ListeningEnd] = {}
        self._words: list[str] = []
        self._noted: dict[str, str] = {}
        # by node: when it reported so, and for whom
        self._waits: dict[str, tuple[float, Sequence[str] | None]] = {}
        self._why: dict[str, Sequence[str]] = {}  # by node: why it waited when it last reported so
        self._adding: set[str] = set()  # nodes with sums due at the end
        self._tallies: dict[str, Mapping[str, Any]] = {}

    def line(self, node: str, adds_up: bool = False) -> tuple[str, int]:
        """For the environment of a node, by which it finds its end, and the descriptor that it has to inherit.

        One that `adds_up` has to report its sums at its end; those of the recorder are those of the
        recording.
        """
        if adds_up and node != RECORDER:
            self._adding.add(node)
        end = self._lines[node] = ListeningEnd()
        return end.address(self._key), end.theirs.fileno()

    def started(self, node: str) -> None:
        """The node has its end, or will never have it."""
        self._lines[node].theirs.close()

    @property
    def warnings(self) -> tuple[str, ...]:
        """Why the run may not be reproducible, as nodes report: each reason once, and how often there were others."""
        more = (
            [f"{self._more_warnings} more warnings, which are in /diagnostics"]
            if self._more_warnings
            else []
        )
        return (*self._warnings, *more)

    @property
    def notes(self) -> tuple[str, ...]:
        """What nodes note, and once for each node or topic that its messages were refused."""
        return tuple(self._noted.values())

    def new_words(self) -> tuple[str, ...]:
        """What the user is to see at once: that time was stopped, or goes on."""
        words, self._words = tuple(self._words), []
        return words

    def waits_for(self, node: str, within: float) -> Sequence[str] | None:
        """The roles for which a node has reported within the last seconds that it waits; None without a report."""
        at, whom = self._waits.get(node, (-inf, None))
        return whom if time.monotonic() - at <= within else None

    def why_it_waits(self, node: str) -> Sequence[str]:
        """The reasons that a node has given when it last reported that it waits."""
        return self._why.get(node, ())

    def look(self) -> None:
        """Take what was reported since the last look."""
        for node, line in self._lines.items():
            for message in line.heard():
                try:
                    self._take(node, Word.decoded(message))
                except (ValueError, TypeError, LookupError, OverflowError):
                    self._noted.setdefault(
                        node, f"node {node} sent an unreadable report: {shown(message)}"
                    )

    def _take(self, node: str, word: Word) -> None:
        text = f"{self._namespace}/{node}: {shown(word.text)}"
        if word.kind == PROGRESS:
            self.time = stamps.to_seconds(int(word.values["stamp"]))
        elif word.kind == WAITS:
            self._waits[node] = time.monotonic(), [str(each) for each in word.values["whom"]]
            self._why[node] = [shown(each, LINE) for each in word.values["why"]]
        elif word.kind == TIMING:
            self.timing = dict(word.values)
        elif word.kind == TALLY:
            self._tallies[node] = {end: _sums(word.values[end]) for end in (READ, WRITTEN)}
        elif word.kind == TIME_SERVICE:
            self.rests = bool(word.values["rests"])
            self._words.append(text)
        elif word.kind == WARNING:
            if text in self._warnings or len(self._warnings) < _NAMED:
                self._warnings[text] = None
            else:
                self._more_warnings += 1
        else:
            self._noted.setdefault(shown(word.what) if word.kind == NOTE else text, text)

    def others_heard(self, recording: Recording) -> list[str]:
        """A line for each node that has taken something on a topic which the node of its role has not sent.

        Compared are the sums at the last step that both ends have, of the recorder those of the
        recording. One of the user's own has none; another one that has reported none, as it was
        killed before, has a line as well.
        """
        silent = [
            node for node in self._lines if node in self._adding and node not in self._tallies
        ]
        if self._tallies:
            self._tallies[RECORDER] = self._tally_of(recording)
        return [
            f"node {node} reported no checksums: another sender in its name would not be noticed"
            for node in silent
        ] + [
            f"node {node} read on {topic} what {writer} did not write: another process sends in its name"
            for node, tally in self._tallies.items()
            for topic, taken in tally[READ].items()
            if (writer := _WRITER_OF[topic]) in self._tallies
            and _differ(taken, self._tallies[writer][WRITTEN].get(topic, {}))
        ]

    def _tally_of(self, recording: Recording) -> Mapping[str, Any]:
        """What the recorder took, by what it has left behind."""
        signals = [signal for signal in PLACES if TOPICS[signal].channels[0] in recording.channels]
        tally, frames = Tally(self._key, signals), np.zeros((_BLOCK, SIZE))
        for step in range(len(recording.time)):
            if step % _BLOCK == 0:
                for signal in signals:
                    for place, name in zip(places(signal), TOPICS[signal].channels, strict=True):
                        series = recording.channels[name][step : step + _BLOCK]
                        frames[: len(series), place] = series
            at = frames[step % _BLOCK].ctypes.data
            tally.add(step, at, at)
        return tally.newest(len(recording.time) - 1, -1)

    def outcome(self, recording: Recording, wall_time: float) -> Outcome:
        """What a run has given that was driven over DDS, and why it may not give the same numbers again."""
        by_the_clock = ["driven by the wall clock"] if self._realtime else []
        reasons = (*by_the_clock, *self.warnings, *self.others_heard(recording))
        return Outcome(recording, wall_time, reasons, self.notes, self.timing)

    def close(self) -> None:
        """Hang up."""
        for line in self._lines.values():
            line.close()


def _sums(values: Any) -> dict[str, dict[str, int]]:
    """Sums by topic and number of a step; ValueError, TypeError or LookupError if a node reported something else."""
    return {
        topic: {str(int(step)): int(total) for step, total in dict(sums).items()}
        for topic, sums in dict(values).items()
        if _WRITER_OF[topic]
    }


def _differ(taken: Mapping[str, int], sent: Mapping[str, int]) -> bool:
    both = taken.keys() & sent.keys()
    return bool(taken and sent) and not (
        both and taken[max(both, key=int)] == sent[max(both, key=int)]
    )


@contextmanager
def node_reports(namespace: str, realtime: bool = False) -> Iterator[NodeReports]:
    """For the time of a run; where that does not come to its end, what was noted is printed all the same."""
    found = NodeReports(namespace, realtime)
    try:
        yield found
    except BaseException:
        found.look()
        for note in found.notes:
            announce(f"note: {note}")
        raise
    finally:
        found.close()
