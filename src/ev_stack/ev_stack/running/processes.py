"""A run over DDS: all nodes in this process, or each as its own, watched up to the end of plant and recorder."""

from __future__ import annotations

import math
import os
import shutil
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import rclpy
from rclpy.parameter import Parameter

from ev_msgs_py.contract import stamps
from ev_msgs_py.contract.roles import MASTER, RECORDER
from ev_nodes.run_role import OF_ROS, node_maker, one_line, security_is_asked_for
from ev_nodes.stepping.runner_line import RUNNER_LINE
from ev_nodes.stepping.spinning import spin
from ev_nodes.stepping.stepped_node import SteppedNode
from ev_nodes.stepping.time_of_day import SetBack, ahead
from ev_stack.recorder_node import RecorderNode
from ev_stack.recording.outcome import Outcome, Progress, RunFailed, announce
from ev_stack.recording.recording import BAG, SIGNALS, load
from ev_stack.running.domain import Place, own_place
from ev_stack.running.node_process import NodeProcess, started_nodes
from ev_stack.running.node_reports import NodeReports, node_reports, observing, refuse_unready
from ev_stack.scenarios.records import Run

# s for the first step behind a time of day that was set back; nodes announce themselves again
_TO_BEGIN = 3.0
# s for the first step of our own nodes: one that was edited compiles its plant on a busy machine
_AT_ALL = 300.0


class Beginning:
    """Watches a run up to its first step; made before its nodes are, and `is_missed` is to be asked often.

    It is `patient` with nodes of others, which may load for long, or stand at a breakpoint. The
    middleware keeps what processes announce of themselves in the order of the time of day. Where
    that is set back while they find each other, one of them may never learn what another one has
    announced. Processes that are started behind it do.
    """

    def __init__(self, patient: bool = False) -> None:
        self._set_back = SetBack(ahead())
        self._deadline = math.inf
        self._given_up = math.inf if patient else time.monotonic() + _AT_ALL

    def is_missed(self, reports: NodeReports) -> bool:
        """Whether the time of day was set back and no step was taken in the seconds behind it.

        RunFailed if no step has been taken for so long that there will be none.
        """
        if reports.time > 0 or reports.rests:
            self._given_up = math.inf
        if time.monotonic() > self._given_up:
            raise RunFailed(
                f"no step was taken within {_AT_ALL:g} s: the nodes do not find or answer each other"
            )
        if self._set_back.is_seen() or (reports.rests and self._deadline < math.inf):
            self._deadline = time.monotonic() + _TO_BEGIN
        if reports.time > 0:
            self._deadline = math.inf
        return time.monotonic() > self._deadline


_RECENT = 0.6  # s for nodes to report, every 0.2 s, for whom they wait
_TO_COME_UP = 10.0  # s that nodes may take to start


class Hanging:
    """Names the node that a run waits for when nothing has gone on for some wall time; `look` is to be called often.

    A node that waits reports for whom; so it is the one at the end of that chain, which reports
    nothing. A chain that comes back ends with the node whose messages do not arrive: it waits for
    answers to them. In lockstep all wait for the master, and it waits for one of them. Real time
    that has begun waits for nobody, and the recorder is asked.
    """

    def __init__(
        self, reports: NodeReports, pids: Mapping[str, int], patience: float, realtime: bool
    ) -> None:
        self._reports, self._pids, self._realtime = reports, dict(pids), realtime
        self._wait = max(patience - 0.2, _RECENT)
        self._since = time.monotonic()
        self._time = reports.time
        self._named = False

    def look(self) -> str | None:
        """One line on the node that does not answer, once for each time that the run stands still."""
        now = time.monotonic()
        # a step may take seconds at a slow pace
        waits_for_its_time = self._reports.waits_for(MASTER, _RECENT) == []
        if self._reports.time != self._time or self._reports.rests or waits_for_its_time:
            self._time, self._since, self._named = self._reports.time, now, False
        elif not self._named and now - self._since > self._wait:
            stopped = [name for name, pid in self._pids.items() if _is_stopped(pid)]
            if not stopped and self._time == 0.0 and now - self._since < _TO_COME_UP:
                return None
            self._named = True
            if stopped:
                return f"stopped by a signal: {', '.join(stopped)}, at {self._time:g} s of simulated time"
            chain = self._chain()
            reasons = dict.fromkeys(
                why for node in chain for why in self._reports.why_it_waits(node)
            )
            line = f"node {chain[-1]} does not answer, at {self._time:g} s of simulated time"
            return f"{line}: {'; '.join(reasons)}" if reasons else line
        return None

    def has_ended(self, name: str) -> None:
        """A node has come to its end: it need not answer any more."""
        self._pids.pop(name, None)

    def _chain(self) -> list[str]:
        """The nodes that wait for each other; the last one does not answer."""
        if MASTER not in self._pids:
            return [RECORDER]
        follows_the_clock = self._realtime and not self._reports.waits_for(MASTER, _RECENT)
        chain = [RECORDER if follows_the_clock else MASTER]
        while whom := [
            each for each in self._reports.waits_for(chain[-1], _RECENT) or () if each in self._pids
        ]:
            if whom[0] in chain:
                break
            chain.append(whom[0])
        return chain


def _is_stopped(pid: int) -> bool:
    """Whether a process stands still by SIGSTOP or the like."""
    try:
        return (Path("/proc") / str(pid) / "stat").read_text().rpartition(")")[2].split()[0] in "Tt"
    except (OSError, IndexError):
        return False


_LOOK_PERIOD = 0.05  # s of wall time between looks at the processes
_PATIENCE = 2.0  # s for a last word to arrive
_TO_CATCH_UP = 20.0  # s more for a recorder behind a plant in real time that has reported its end


class WatchedRun:
    """Follows simulated time and the processes of a run, and names the node that does not answer."""

    def __init__(self, place: Place, nodes: Sequence[NodeProcess], reports: NodeReports) -> None:
        run = place.run
        self._place, self._run, self._nodes, self._reports = place, run, nodes, reports
        self._last = stamps.to_seconds(stamps.from_seconds(run.duration) // run.period * run.period)
        answer_timeout = run.configurations[MASTER].extra.answer_timeout
        pids = {node.name: node.process.pid for node in nodes}
        self._hanging = Hanging(reports, pids, answer_timeout, run.realtime)
        # wall time up to which the recorder may report that it has everything
        self._patience = math.inf
        self._began: float | None = None  # wall time of the last look at a car at rest in time
        # wall time of the first look at a car at its last instant
        self._arrived: float | None = None

    def drive(self, beginning: Beginning, progress: Progress) -> bool:
        """Watch the run up to its end; False, with a line, where it has not begun and never will.

        RunFailed if a node ends before the run does, KeyboardInterrupt if a stop is asked for.
        """
        ending = {MASTER, RECORDER}
        while ending:
            if self._place.stop.received:
                raise KeyboardInterrupt
            looked = time.monotonic()
            time.sleep(_LOOK_PERIOD)
            self._follow_time(looked)
            progress(self._reports.time)
            if beginning.is_missed(self._reports):
                announce(
                    "the time of day was set back, and the run has not begun since: its nodes are restarted"
                )
                return False
            for word in (*self._reports.new_words(), self._hanging.look()):
                if word is not None:
                    announce(word)
            ending -= {node.name for node in self._nodes if self._has_ended(node)}
        self._arrived = self._arrived or time.monotonic()
        progress(self._run.duration)
        return True

    def outcome(self) -> Outcome:
        """What a run gave that has come to its end, and its nodes as well; RunFailed if its recorder was stopped."""
        self._reports.look()
        recording = load(self._place.directory / SIGNALS)
        # real time does not wait
        if recording.time[-1] < self._last - 0.5 * stamps.to_seconds(self._run.period):
            raise RunFailed(
                f"node {RECORDER} was stopped, at {recording.time[-1]:g} s of simulated time"
            )
        wall_time = self._arrived - self._began if self._arrived and self._began else 0.0
        return self._reports.outcome(recording, wall_time)

    def _follow_time(self, looked: float) -> None:
        before = self._reports.time
        self._reports.look()
        if self._reports.time != before:
            # the recorder still has to keep what the plant sent before its end
            self._patience = math.inf
        if self._began is None and self._reports.time > 0:
            self._began = looked
        if self._arrived is None and self._reports.time >= self._last:
            self._arrived = time.monotonic()

    def _has_ended(self, node: NodeProcess) -> bool:
        """Whether a node has come to its end in order; RunFailed if in another way, or before the run has."""
        code = node.process.poll()
        if code is None:
            return False
        if code != 0 or node.name not in (MASTER, RECORDER):
            raise RunFailed(f"{node.failure()}, at {self._reports.time:g} s of simulated time")
        self._hanging.has_ended(node.name)
        now, real_time = time.monotonic(), bool(self._reports.timing)
        self._patience = min(self._patience, now + _PATIENCE)
        if self._reports.time < self._last and now > self._patience + (
            _TO_CATCH_UP if real_time else 0.0
        ):
            slow = node.name == MASTER and real_time  # the plant has reported its end
            what = f"node {RECORDER} lacks what was sent last" if slow else node.failure()
            raise RunFailed(f"{what}, at {self._reports.time:g} s of simulated time")
        return True


def run_in_processes(
    run: Run,
    directory: Path,
    bag: bool,
    progress: Progress,
    own_nodes: Mapping[str, Sequence[str]] | None = None,
) -> Outcome:
    """Drive a run to its end, every node as its own process over DDS; the recorder writes into `directory`.

    `own_nodes` are commands by role that are started in the place of our nodes, with the same ROS
    arguments.

    RunFailed, with a line that names the node, if one ends before the run does; KeyboardInterrupt
    if Ctrl-C or SIGTERM came. All nodes are stopped then.
    """
    refuse_unready()
    with own_place(run, directory, bag) as place:
        while True:
            beginning = Beginning(patient=bool(own_nodes))
            with node_reports(run.namespace, run.realtime) as reports:
                with started_nodes(place, own_nodes or {}, reports) as nodes:
                    watched = WatchedRun(place, nodes, reports)
                    has_begun = watched.drive(beginning, progress)
                if has_begun:  # all have reported their last
                    return watched.outcome()
            (directory / SIGNALS).unlink(missing_ok=True)
            shutil.rmtree(directory / BAG, ignore_errors=True)


_OBSERVER = "run_scenario"  # the name of what is in the graph beside the nodes
_GLANCE_PERIOD = 0.1  # s of wall time between looks at simulated time


def run_in_process(run: Run, directory: Path, bag: bool, progress: Progress) -> Outcome:
    """Drive a run to its end; everything that the recorder writes is in `directory` then.

    KeyboardInterrupt, when all nodes have finished what they did, if Ctrl-C or SIGTERM came before
    the end.
    """
    if security_is_asked_for(os.environ):
        raise RunFailed(
            "--in-process: DDS security gives keys to processes, not to nodes; drive one process per node"
        )
    nodes: list[SteppedNode] = []
    with (
        own_place(run, directory, bag) as place,
        observing(run.namespace, place.domain, _OBSERVER) as observer,
        node_reports(run.namespace, run.realtime) as reports,
    ):
        try:
            for name, values in place.parameters.items():
                with _line(reports, name):
                    nodes.append(_node(name, run.namespace, values, observer.context))
            ending = [node for node in nodes if node.get_name() in (MASTER, RECORDER)]
            next_look = 0.0

            def finished() -> bool:
                nonlocal next_look
                if time.monotonic() >= next_look:
                    reports.look()
                    progress(reports.time)
                    next_look = time.monotonic() + _GLANCE_PERIOD
                return all(node.done for node in ending) or place.stop.received

            start = time.monotonic()
            spin(nodes, finished)
            wall_time = time.monotonic() - start
            if not all(node.done for node in ending):
                raise KeyboardInterrupt
            progress(run.duration)
        except OF_ROS as error:  # what ends a node that is a process of its own
            raise RunFailed(one_line(error)) from None
        finally:
            for node in nodes:
                node.close()
                node.destroy_node()
            reports.look()
    return reports.outcome(load(directory / SIGNALS), wall_time)


@contextmanager
def _line(reports: NodeReports, node: str) -> Iterator[None]:
    """What is made in the block finds the line of a node in the environment, as a process would."""
    os.environ[RUNNER_LINE], _ = reports.line(node)
    try:
        yield
    finally:
        del os.environ[RUNNER_LINE]
        reports.started(node)


def parameter_overrides(values: Mapping[str, Any]) -> list[Parameter]:
    """Dotted names and values as a node takes them."""
    return [Parameter(name, value=value) for name, value in values.items()]


def _node(name: str, namespace: str, values: dict, context: rclpy.Context) -> object:
    arguments = {
        "context": context,
        "namespace": namespace,
        "parameter_overrides": parameter_overrides(values),
    }
    return RecorderNode(**arguments) if name == RECORDER else node_maker(name)(**arguments)
