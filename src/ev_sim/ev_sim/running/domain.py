"""What no other run on this machine uses: a ROS domain and, in real time, the channels of a CAN bus."""

from __future__ import annotations

import fcntl
import os
import socket
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ev_core.bus.parameters import CIRCUITS, LOOPBACK, BusInterface
from ev_core.bus.socketcand_hub import HOST
from ev_core.nodes.ros_domain import given_domain
from ev_core.nodes.stop_request import StopRequest
from ev_msgs_py.refusal import ParameterError
from ev_sim.recording.outcome import RunFailed, announce
from ev_sim.recording.recording import PARAMETERS
from ev_sim.running.children import ends_with_us
from ev_sim.running.offline import node_parameters, write_parameter_file
from ev_sim.scenarios.scenario import Run

_RANGE = "ROS_AUTOMATIC_DISCOVERY_RANGE"
_DOMAINS = range(1, 102)  # those that are safe on every operating system
_FIRST_PORT, _PORTS_PER_DOMAIN = 7400, 250  # of DDS: multicast discovery of a domain
_PARTICIPANTS = 32  # among which nodes look for each other (config/fastdds.xml)
_UNICAST = 10  # offset of the first participant's port


@dataclass(frozen=True, slots=True)
class Place:
    """Where a run is driven over DDS: the parameters of its nodes by name, also as a file in its folder."""

    run: Run
    directory: Path
    domain: int
    parameters: dict[str, dict[str, Any]]
    stop: StopRequest


@contextmanager
def own_place(run: Run, directory: Path, bag: bool) -> Iterator[Place]:
    """A domain, names and a bus for one run; RunFailed if one of them cannot be had."""
    with (
        free_domain() as domain,
        own_namespace(domain, run.namespace),
        StopRequest(patient=True) as stop,
        real_bus(run, domain, directory) as bus,
    ):
        parameters = node_parameters(run, directory, bag, bus)
        write_parameter_file(directory / PARAMETERS, run, parameters)
        announce(f"{run.name}: ROS_DOMAIN_ID={domain}, namespace {run.namespace}")
        yield Place(run, directory, domain, parameters, stop)


class NoFreeDomain(RunFailed):
    """All domains are in use."""


@contextmanager
def free_domain() -> Iterator[int]:
    """A domain id without participants, reserved against other runs of this kind until the end of the block.

    NoFreeDomain if there is none, RunFailed if ROS_DOMAIN_ID is no domain, or if nodes are not to find each other.

    ROS_DOMAIN_ID goes before: it is set to look at the run from outside.
    """
    if os.environ.get(_RANGE) == "OFF":
        raise RunFailed(f"{_RANGE}=OFF is refused: no node would find another one, expected LOCALHOST or SUBNET")
    try:
        given = given_domain(os.environ)
    except ParameterError as error:
        raise RunFailed(str(error)) from None
    if given is not None:
        yield given
        return
    for domain in _DOMAINS:
        with _reservation(domain) as reserved:
            if reserved and _is_silent(domain):
                yield domain
                return
    raise NoFreeDomain(f"all ROS domains from {_DOMAINS[0]} to {_DOMAINS[-1]} are in use{_blocked()}")


@contextmanager
def own_namespace(domain: int, namespace: str) -> Iterator[None]:
    """For the time of the block no other run of this user has nodes of the same names; RunFailed if one has them.

    Nobody would believe either of two nodes of one name, and both runs would stand still.
    """
    with _reservation(f"{domain}_{os.getuid()}{namespace.replace('/', '_')}") as reserved:
        if not reserved:
            raise RunFailed(
                f"ROS domain {domain} has a run in the namespace {namespace} already: wait, or take another"
            )
        yield


def reserved_domains() -> list[int]:
    """The domains in which runs of this kind are under way."""
    domains = []
    for domain in _DOMAINS:
        if _lock_file(domain).exists():
            with _reservation(domain) as reserved:
                if not reserved:
                    domains.append(domain)
    return domains


def discovery_port(domain: int, participant: int) -> int:
    """The UDP port at which a participant of a domain, counted from 0, receives announcements of others."""
    return _FIRST_PORT + _PORTS_PER_DOMAIN * domain + _UNICAST + 2 * participant


@contextmanager
def _reservation(what: object) -> Iterator[bool]:
    """Whether it could be reserved, for the time of the block; also false if the lock is another user's."""
    with ExitStack() as stack:
        try:
            lock = stack.enter_context(open(_lock_file(what), "wb", opener=_opened_in_place))
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            yield False
        else:
            yield True


def _opened_in_place(path: str, flags: int) -> int:
    """Everybody may write into the folder of the locks: a link there is not followed.

    Nor does a pipe there hold us up. Nobody else may open the file: to open it is enough to lock it.
    """
    return os.open(path, (flags | os.O_NOFOLLOW | os.O_NONBLOCK) & ~os.O_TRUNC, 0o600)


def _blocked() -> str:
    """Which lock file, or folder of them, is not ours to write, and whose it is; nothing if all of them are."""
    for domain in _DOMAINS:
        try:
            os.close(_opened_in_place(str(_lock_file(domain)), os.O_WRONLY | os.O_CREAT))
        except OSError as error:
            file = _lock_file(domain)
            found = file if os.path.lexists(file) else file.parent
            return f", or blocked: {found} belongs to user {found.lstat().st_uid} ({error.strerror})"
    return ""


def _lock_file(what: object) -> Path:
    return Path(tempfile.gettempdir()) / f"ev_stack_domain_{what}.lock"


def _is_silent(domain: int) -> bool:
    """Whether the ports of all participants can be had; the first ones may be gone while later ones live on."""
    ports = (discovery_port(domain, participant) for participant in range(_PARTICIPANTS))
    for port in (_FIRST_PORT + _PORTS_PER_DOMAIN * domain, *ports):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            try:
                probe.bind(("", port))
            except OSError:
                return False
    return True


_ENDS = ("inverter_gateway", "test_bench")
# Two for each ROS domain, so that runs at the same time do not receive the frames of each other; below those that Linux
# gives to sockets which ask for none (from 32768 on), one of which would be in use now and then.
_FIRST_CAN_PORT = 28111
_ECHO_PATIENCE = 0.5  # s for a frame to come back


@contextmanager
def real_bus(run: Run, domain: int, directory: Path) -> Iterator[dict[str, dict[str, Any]]]:
    """Further parameters of the nodes at both ends of a bus, by name; nothing in lockstep and where there is none.

    Channels without a name get one of this run alone. RunFailed if a hub is needed and does not start.
    """
    if not (run.realtime and all(name in run.configurations for name in _ENDS)):
        yield {}
        return
    bus = run.configurations[_ENDS[0]].parameters.bus
    with _channels(bus, domain) as (interface, channels):
        announce(f"{run.name}: CAN over {interface}, {' and '.join(channels)}")
        names = [f"bus.channel_{circuit}" for circuit in CIRCUITS]
        given = {"bus.interface": interface, "bus.address": bus.address, **dict(zip(names, channels, strict=True))}
        log = {"bus.log": str(directory / bus.log)} if bus.log else {}
        yield {_ENDS[0]: given | log, _ENDS[1]: given}


@contextmanager
def _channels(bus: BusInterface, domain: int) -> Iterator[tuple[str, list[str]]]:
    """Interface and channels, those that are named or free ones."""
    named = list(bus.channels().values())
    if bus.channel_11 or bus.channel_12 or bus.interface not in ("udp_multicast", "socketcand"):
        yield bus.interface, named
        return
    if bus.interface == "udp_multicast":
        free = [f"{name.partition(':')[0]}:{_FIRST_CAN_PORT + 2 * domain + n}" for n, name in enumerate(named)]
        if bus.address != LOOPBACK or _works(free[0]):
            yield bus.interface, free
            return
    with _hub() as place:
        yield "socketcand", [f"can{circuit}@{place}" for circuit in CIRCUITS]


def _works(channel: str) -> bool:
    """Whether what is sent to a multicast group comes back."""
    from ev_core.bus.channel import Channel
    from ev_core.bus.opening import BusError
    from ev_msgs_py.can.frame_length import Frame

    try:
        probe = Channel("udp_multicast", channel)
    except BusError:
        return False
    try:
        probe.send(Frame(0, b""))
        end = time.monotonic() + _ECHO_PATIENCE
        while probe.unsent == probe.received == 0 and time.monotonic() < end:
            probe.receive()
        return probe.received > 0
    finally:
        probe.close()


@contextmanager
def _hub() -> Iterator[str]:
    """HOST:PORT of a hub that lasts as long as the block."""
    words = [sys.executable, "-m", "ev_sim.commands.can_hub", "--port", "0"]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True, preexec_fn=ends_with_us()) as hub:
        try:
            assert hub.stdout is not None
            line = hub.stdout.readline().strip()
            place = line.rpartition(" ")[2]
            if not place.startswith(f"{HOST}:"):
                raise RunFailed(f"the hub for CAN frames did not start: {line or 'it said nothing'}")
            yield place
        finally:
            hub.terminate()
