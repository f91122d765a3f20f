"""The nodes of a run as processes of their own: started and stopped, and nothing left behind.

How it works: a node is started in a session of its own, so that Ctrl-C reaches only the runner,
which stops all nodes in order: first SIGINT to all, then, after some patience, SIGKILL to their
groups. Should the runner itself be killed, the system kills our nodes (`ends_with_us`), and a guard
kills what a user's command has started.
"""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

from ev_core.lockstep.finding import is_code
from ev_core.methods.register import node_package
from ev_msgs_py.contract.roles import RECORDER
from ev_msgs_py.refusal import shown
from ev_nodes.run_role import NO_LOG_FILE, SILENTLY
from ev_nodes.stepping.runner_line import RUNNER_LINE
from ev_nodes.stepping.stop_request import hold_back
from ev_stack.recording.outcome import RunFailed
from ev_stack.recording.recording import LOG, PARAMETERS
from ev_stack.running.children import ending_with_us, ends_with_us, same_addresses
from ev_stack.running.domain import Place
from ev_stack.running.node_reports import NodeReports, enclave
from ev_stack.scenarios.records import Run

_ROOM = 65536  # bytes; with less a node cannot even write what went wrong
# s for processes to stop when they are asked to: all of them have last words if the run has come to
# its end.
_PATIENCE, _AT_THE_END = 2.0, 10.0


def package_of(node: str) -> str:
    """The package with the node of a role, or with the recorder; LookupError as `node_package`."""
    return __package__.partition(".")[0] if node == RECORDER else node_package(node)


def command(name: str) -> list[str]:
    """Words that start the node of a role.

    They are those that `ros2 run` would start: that itself would not hand on the line to the
    runner. RunFailed if the workspace is not built or not sourced, or if the node comes from
    several packages.
    """
    try:
        package = package_of(name)
    except LookupError as error:
        raise RunFailed(str(error)) from None
    for prefix in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep):
        path = Path(prefix) / "lib" / package / name
        if path.exists():
            return [str(path)]
    raise RunFailed(
        f"executable {package} {name} is not found: source scripts/setup.sh, or"
        " install/local_setup.bash of a workspace of your own"
    )


@dataclass
class NodeProcess:
    """One node, its process and the file with what it printed."""

    name: str
    process: subprocess.Popen
    log: Path
    guard: subprocess.Popen | None = None  # kills what it has started when we are killed

    def failure(self) -> str:
        """One line on how the process ended."""
        code = self.process.returncode
        if code == 0:  # as a node ends when it is asked to
            return f"node {self.name} was stopped"
        how = (
            f"was killed by {signal.Signals(-code).name}"
            if code < 0
            else f"ended with status {code}"
        )
        lines = self.log.read_text(errors="replace").strip().splitlines()
        # The last line of a node that was killed is one from before that, and no reason.
        last = f": {shown(lines[-1])}" if lines and code > 0 else ""
        if shutil.disk_usage(self.log.parent).free < _ROOM:
            last = f": no space left on device, {self.log.parent}"
        return f"node {self.name} {how}{last}"

    def end(self) -> None:
        """Kill the process and whatever it has started."""
        self.send(signal.SIGKILL)
        self.process.wait()
        if self.guard is not None:
            # The guard has nothing to guard any more; `communicate` reaps it and closes its pipe.
            self.guard.kill()
            self.guard.communicate()

    def send(self, kind: signal.Signals) -> None:
        """Send a signal to the process and whatever it has started."""
        with suppress(ProcessLookupError):
            # The group: a command of the user's may be a shell that has started the node.
            os.killpg(self.process.pid, kind)


def _started(
    name: str, words: Sequence[str], ours: bool, place: Place, reports: NodeReports
) -> NodeProcess:
    """The node of a role, by a command, with its log and a line to the runner, on which its `reports` come.

    Ctrl-C and SIGTERM wait until a node of `ours` can stop in order, which takes a second of
    loading; the nodes of others may never let them in.
    """
    run, log = place.run, place.directory / LOG / f"{name}.log"
    log.parent.mkdir(exist_ok=True)
    arguments = ["--ros-args", NO_LOG_FILE, "-r", f"__ns:={run.namespace}"]
    arguments += ["--params-file", str(place.directory / PARAMETERS)]
    arguments += [*_said_by_us(name, run, place.directory), *enclave(name, run.namespace)]
    line, inherited = reports.line(name)
    with log.open("wb") as output:
        try:
            with same_addresses():
                process = subprocess.Popen(
                    [*words, *arguments],
                    stdin=subprocess.DEVNULL,
                    stdout=output,
                    stderr=subprocess.STDOUT,
                    env={
                        **os.environ,
                        "ROS_DOMAIN_ID": str(place.domain),
                        SILENTLY: "1",
                        RUNNER_LINE: line,
                    },
                    pass_fds=[inherited],
                    preexec_fn=_before_exec(ours),
                    start_new_session=True,  # Ctrl-C is for us: we stop the nodes in order
                )
        except OSError as error:
            raise RunFailed(
                f"node {name} cannot be started: {words[0]}: {error.strerror}"
            ) from None
        finally:
            # Our copy of its end is closed, so that the line ends with the node.
            reports.started(name)
    return NodeProcess(name, process, log, None if ours else ending_with_us(process.pid))


def _said_by_us(name: str, run: Run, folder: Path) -> list[str]:
    """Parameters that a node takes from no file: paths of code and log, a network."""
    configuration = run.configurations.get(name)
    if configuration is None:
        return []
    method, bus = configuration.method.name, getattr(configuration.parameters, "bus", None)
    given = {"method": method} if is_code(method) else {}
    if run.realtime and getattr(bus, "log", ""):
        given["bus.log"] = str(folder / bus.log)
    gateway = run.configurations.get("inverter_gateway")
    # both ends have that of the gateway (`real_bus`)
    if run.realtime and bus is not None and gateway is not None:
        given["bus.address"] = gateway.parameters.bus.address
    return [word for key, path in given.items() for word in ("-p", f'{key}:="{path}"')]


def _before_exec(ours: bool) -> Callable[[], None]:
    dies_with_us = ends_with_us()

    def before() -> None:
        if ours:
            hold_back()
        if dies_with_us is not None:
            dies_with_us()

    return before


@contextmanager
def started_nodes(
    place: Place, own: Mapping[str, Sequence[str]], reports: NodeReports
) -> Iterator[list[NodeProcess]]:
    """The processes of all nodes, with commands of others for some of them.

    Raises RunFailed if one cannot be started.
    """
    nodes: list[NodeProcess] = []
    try:
        for name in place.parameters:
            words = own.get(name)
            nodes.append(_started(name, words or command(name), not words, place, reports))
        yield nodes
    # A run that fails has no last words: its nodes get less time.
    except BaseException:
        _stop(nodes, _PATIENCE)
        raise
    _stop(nodes, _AT_THE_END)


def _stop(nodes: list[NodeProcess], patience: float) -> None:
    """Ask all processes to stop, then make them, with whatever they have started."""
    for node in nodes:
        if node.process.poll() is None:
            node.send(signal.SIGINT)
    # One for all: they stop side by side.
    deadline = time.monotonic() + patience
    for node in nodes:
        with suppress(subprocess.TimeoutExpired):
            node.process.wait(max(deadline - time.monotonic(), 0.0))
    for node in nodes:
        node.end()
