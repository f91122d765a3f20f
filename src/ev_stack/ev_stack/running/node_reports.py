"""View of a runner on its nodes: their reports, each on its line, and the graph.

How it works: each node has a line of its own to the runner, which it inherits as a descriptor, so
the sender of each report is known. `look` takes what has come on all lines, and never waits.
"""

from __future__ import annotations

import os
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from math import inf
from typing import Any

import rclpy
from rclpy.impl.implementation_singleton import rclpy_implementation
from rclpy.node import Node

from ev_msgs_py.contract import stamps
from ev_msgs_py.refusal import LINE, shown
from ev_nodes.run_role import NO_LOG_FILE, one_line, refuse_weak_security, security_is_asked_for
from ev_nodes.stepping.runner_line import (
    NOTE,
    PROGRESS,
    TIME_SERVICE,
    TIMING,
    WAITS,
    WARNING,
    ListeningEnd,
    Word,
)
from ev_stack.recording.outcome import Outcome, RunFailed, announce
from ev_stack.recording.recording import Recording

_NAMED = 20  # warnings; more than these are counted only


@contextmanager
def observing(namespace: str, domain: int, name: str) -> Iterator[Node]:
    """A node in the graph of a domain.

    Raises RunFailed where ROS 2 refuses it, as without keys, or fails.
    """
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
        yield observer
        observer.destroy_node()
    except rclpy_implementation.RCLError as error:
        raise RunFailed(one_line(error)) from None
    finally:
        context.try_shutdown()


def refuse_unready() -> None:
    """RunFailed where ROS 2 would leave security away in silence."""
    try:
        refuse_weak_security(os.environ)
    except RuntimeError as error:
        raise RunFailed(one_line(error)) from None


def enclave(node: str, namespace: str) -> list[str]:
    """The ROS arguments that name the keys of a process, where security is asked for."""
    return (
        ["--ros-args", "--enclave", f"{namespace}/{node}"]
        if security_is_asked_for(os.environ)
        else []
    )


class NodeReports:
    """Simulated time, lines for the user, and why the run may not be reproducible, as its nodes report."""

    def __init__(self, namespace: str, realtime: bool = False) -> None:
        self.time = 0.0
        self._warnings: dict[str, None] = {}
        self._more_warnings = 0
        # how well real time was kept, as the master reports at its end
        self.timing: dict[str, Any] = {}
        self.rests = False  # whether a service has stopped time
        self._namespace, self._realtime = namespace.rstrip("/"), realtime
        self._lines: dict[str, ListeningEnd] = {}
        self._words: list[str] = []
        self._noted: dict[str, str] = {}
        # by node: when it reported so, and for whom
        self._waits: dict[str, tuple[float, Sequence[str] | None]] = {}
        self._why: dict[str, Sequence[str]] = {}  # by node: why it waited when it last reported so

    def line(self, node: str) -> tuple[str, int]:
        """Value for the environment of a node, by which it finds its end, and its descriptor."""
        end = self._lines[node] = ListeningEnd()
        return end.address, end.theirs.fileno()

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
        """Notes of nodes, and one for each node or topic with refused messages."""
        return tuple(self._noted.values())

    def new_words(self) -> tuple[str, ...]:
        """Words for the user at once: that time was stopped, or goes on."""
        words, self._words = tuple(self._words), []
        return words

    def waits_for(self, node: str, within: float) -> Sequence[str] | None:
        """The roles for which a node has reported within the last seconds that it waits.

        None without a report.
        """
        # Infinitely long ago: a node that never reported counts as one without a report.
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
                # A user's node may send anything on its line; it must not end the run.
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
        elif word.kind == TIME_SERVICE:
            self.rests = bool(word.values["rests"])
            self._words.append(text)
        elif word.kind == WARNING:
            # A node that warns at every step must not fill the memory.
            if text in self._warnings or len(self._warnings) < _NAMED:
                self._warnings[text] = None
            else:
                self._more_warnings += 1
        else:
            self._noted.setdefault(shown(word.what) if word.kind == NOTE else text, text)

    def outcome(self, recording: Recording, wall_time: float) -> Outcome:
        """Outcome of a run over DDS, and why it may not give the same numbers again."""
        by_the_clock = ["driven by the wall clock"] if self._realtime else []
        reasons = (*by_the_clock, *self.warnings)
        return Outcome(recording, wall_time, reasons, self.notes, self.timing)

    def close(self) -> None:
        """Hang up."""
        for line in self._lines.values():
            line.close()


@contextmanager
def node_reports(namespace: str, realtime: bool = False) -> Iterator[NodeReports]:
    """Reports during a run; a run without an end prints their notes all the same."""
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
