"""Every node of a run as its own process: started, watched, stopped, and nothing left behind."""

from __future__ import annotations

import math
import os
import shutil
import signal
import subprocess
import time
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path

from ev_msgs_py.compiling import node_loop
from ev_msgs_py.contract import stamps
from ev_msgs_py.contract.roles import MASTER, RECORDER
from ev_msgs_py.lockstep.methods import node_package
from ev_msgs_py.nodes.stop_request import StopRequest
from ev_sim.running.beginning import Beginning, NotBegun
from ev_sim.running.domain import free_domain
from ev_sim.running.hanging import Hanging
from ev_sim.running.node_parameters import node_parameters, write_parameter_file
from ev_sim.running.node_process import NodeProcess, start_node
from ev_sim.running.observer import Observer
from ev_sim.running.observing import observing
from ev_sim.running.outcome import Outcome, Progress, RunFailed, not_reproducible
from ev_sim.running.output_folder import forget_recording
from ev_sim.running.progress_bar import announce
from ev_sim.running.real_bus import real_bus
from ev_sim.running.recording.recording import load
from ev_sim.running.scenarios.scenario import Run

_LOOK_PERIOD = 0.05  # s of wall time between looks at the processes
_PATIENCE = 2.0  # s for a process to stop when it is asked to, and for a last word to arrive
_TO_CATCH_UP = 20.0  # s more for a recorder behind a plant in real time that said that it has come to its end


def run_in_processes(
    run: Run, directory: Path, bag: bool, progress: Progress, own_nodes: Mapping[str, Sequence[str]] | None = None
) -> Outcome:
    """Drive a run to its end, every node as its own process over DDS; the recorder writes into `directory`.

    `own_nodes` are commands by role that are started in the place of our nodes, with the same ROS arguments.

    RunFailed, with a line that names the node, if one ends before the run does; KeyboardInterrupt if Ctrl-C or SIGTERM
    came. All nodes are stopped then.
    """
    file = directory / "parameters.yaml"
    node_loop.keep()  # whoever has updated the sources has set up nothing anew
    with (
        free_domain() as domain,
        StopRequest(patient=True) as stop,
        real_bus(run, domain, directory) as bus,
    ):
        parameters = node_parameters(run, directory, bag, bus)
        write_parameter_file(file, run, parameters)
        while True:
            beginning = Beginning()
            nodes: list[NodeProcess] = []
            with observing(run.namespace, domain) as observer:
                announce(f"{run.name}: ROS_DOMAIN_ID={domain}, namespace {run.namespace}")
                try:
                    for name in parameters:
                        own = (own_nodes or {}).get(name)
                        nodes.append(start_node(name, own or command(name), not own, run, file, domain))
                    return _watch(run, nodes, observer, directory, progress, stop, beginning)
                except NotBegun as error:
                    announce(f"{error}: its nodes are started anew")
                finally:
                    _stop(nodes)
            forget_recording(directory)


def package_of(node: str) -> str:
    """The package with the node of a role, or with the recorder; LookupError as `node_package`."""
    return __package__.partition(".")[0] if node == RECORDER else node_package(node)


def command(name: str) -> list[str]:
    """How the node of a role is started: by `ros2 run` where there is one, else what that would start.

    RunFailed if the workspace is not built or not sourced, or if the node comes from several packages.
    """
    try:
        package = package_of(name)
    except LookupError as error:
        raise RunFailed(str(error)) from None
    if shutil.which("ros2") is not None and "ROS_DISTRO" in os.environ:
        return ["ros2", "run", package, name]
    for prefix in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep):
        path = Path(prefix) / "lib" / package / name
        if path.exists():
            return [str(path)]
    raise RunFailed(f"executable {package} {name} is not found: source install/local_setup.bash of the workspace")


def _watch(
    run: Run,
    nodes: list[NodeProcess],
    observer: Observer,
    directory: Path,
    progress: Progress,
    stop: StopRequest,
    beginning: Beginning,
) -> Outcome:
    """Look at processes and time until plant and recorder have come to their end by themselves."""
    started = ended = None  # wall time of the last look at a car at rest in time, and of the first at its last instant
    ending = {MASTER, RECORDER}
    last = stamps.to_seconds(stamps.from_seconds(run.duration) // run.period * run.period)
    answer_timeout = run.configurations[MASTER].extra.answer_timeout
    hanging = Hanging(observer, {node.name: node.process.pid for node in nodes}, answer_timeout)
    patience = math.inf  # wall time up to which the recorder may tell that it has everything
    while ending:
        if stop.received:
            raise KeyboardInterrupt
        looked = time.monotonic()
        time.sleep(_LOOK_PERIOD)
        before = observer.time
        observer.look()
        progress(observer.time)
        if observer.time != before:
            patience = math.inf  # the recorder still has to keep what the plant said before its end
        beginning.look(observer)
        for word in (*observer.new_words(), hanging.look()):
            if word is not None:
                announce(word)
        if started is None and observer.time > 0:
            started = looked
        if ended is None and observer.time >= last:
            ended = time.monotonic()
        for node in nodes:
            code = node.process.poll()
            if code == 0 and node.name in (MASTER, RECORDER):
                ending.discard(node.name)
                hanging.has_ended(node.name)
                patience = min(patience, time.monotonic() + _PATIENCE)
                if observer.time < last and time.monotonic() > patience + (_TO_CATCH_UP if observer.timing else 0.0):
                    slow = node.name == MASTER and observer.timing  # the plant has told that it came to its end
                    who = f"node {RECORDER} lacks what was said last," if slow else node.failure()
                    raise RunFailed(f"{who} at {observer.time:g} s of simulated time")
            elif code is not None:
                raise RunFailed(f"{node.failure()}, at {observer.time:g} s of simulated time")
    now = time.monotonic()
    wall_time = (ended or now) - (started or now)
    progress(run.duration)
    recording = load(directory / "signals.npz")
    if recording.time[-1] < last - 0.5 * stamps.to_seconds(run.period):  # real time does not wait for its recorder
        raise RunFailed(f"node {RECORDER} was stopped, at {recording.time[-1]:g} s of simulated time")
    warnings, notes = not_reproducible(run, observer.warnings), observer.notes
    return Outcome(recording, wall_time, warnings, notes, observer.timing)


def _stop(nodes: list[NodeProcess]) -> None:
    """Ask all processes to stop, then make them, with whatever they have started."""
    for node in nodes:
        if node.process.poll() is None:
            node.send(signal.SIGINT)
    deadline = time.monotonic() + _PATIENCE
    for node in nodes:
        with suppress(subprocess.TimeoutExpired):
            node.process.wait(max(deadline - time.monotonic(), 0.0))
    for node in nodes:
        node.send(signal.SIGKILL)
        node.process.wait()
