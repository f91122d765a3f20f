"""Things that one run of this machine has alone: a ROS domain, names, and an offered bus.

How it works: a domain is reserved by a lock on a file in the folder for temporary files, which ends
with the process however that ends. A lock shows only runs of this kind, so the ports of the domain
are tried as well: another program of ROS holds one of them.
"""

from __future__ import annotations

import fcntl
import os
import socket
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ev_msgs_py.refusal import ParameterError
from ev_nodes.stepping.ros_domain import given_domain
from ev_nodes.stepping.stop_request import StopRequest
from ev_stack.recording.outcome import RunFailed, announce
from ev_stack.recording.recording import PARAMETERS
from ev_stack.running.buses import buses
from ev_stack.running.offline import node_parameters, write_parameter_file
from ev_stack.scenarios.records import Run

_RANGE = "ROS_AUTOMATIC_DISCOVERY_RANGE"
_DOMAINS = range(1, 102)  # those that are safe on every operating system
_FIRST_PORT, _PORTS_PER_DOMAIN = 7400, 250  # of DDS: multicast discovery of a domain
_PARTICIPANTS = 32  # among which nodes look for each other (config/fastdds.xml)
_UNICAST = 10  # offset of the first participant's port


@dataclass(frozen=True, slots=True)
class Place:
    """Place of a run over DDS: its nodes' parameters by name, also as a file in its folder."""

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
        ExitStack() as stack,
    ):
        further: dict[str, dict[str, Any]] = {}
        for bus in buses():
            further |= stack.enter_context(bus.real_bus(run, domain, directory))
        parameters = node_parameters(run, directory, bag, further)
        write_parameter_file(directory / PARAMETERS, run, parameters)
        announce(f"{run.name}: ROS_DOMAIN_ID={domain}, namespace {run.namespace}")
        yield Place(run, directory, domain, parameters, stop)


class NoFreeDomain(RunFailed):
    """All domains are in use."""


@contextmanager
def free_domain() -> Iterator[int]:
    """A domain id without participants, reserved against other runs of this kind until the end of the block.

    NoFreeDomain if there is none, RunFailed if ROS_DOMAIN_ID is no domain, or if nodes are not to
    find each other.

    ROS_DOMAIN_ID goes before: it is set to look at the run from outside.
    """
    if os.environ.get(_RANGE) == "OFF":
        raise RunFailed(
            f"{_RANGE}=OFF is refused: no node would find another one, expected LOCALHOST or SUBNET"
        )
    try:
        given = given_domain(os.environ)
    except ParameterError as error:
        raise RunFailed(str(error)) from None
    if given is not None:
        yield given
        return
    for domain in _DOMAINS:
        with _reservation(domain) as reserved:
            # Reserved first, or two runs could both find it silent; it is silent to other programs
            # of ROS.
            if reserved and _is_silent(domain):
                yield domain
                return
    raise NoFreeDomain(
        f"all ROS domains from {_DOMAINS[0]} to {_DOMAINS[-1]} are in use{_blocked()}"
    )


@contextmanager
def own_namespace(domain: int, namespace: str) -> Iterator[None]:
    """Reserve the names of nodes against other runs of this user.

    Raises RunFailed if one has them. Two nodes of one name are not believed, and both runs would
    stand still.
    """
    with _reservation(f"{domain}_{os.getuid()}{namespace.replace('/', '_')}") as reserved:
        if not reserved:
            raise RunFailed(
                f"ROS domain {domain} has a run in the namespace {namespace} already: wait, or take"
                " another"
            )
        yield


@contextmanager
def own_bus(domain: int) -> Iterator[None]:
    """Reserve the bus that belongs to a domain; RunFailed if another run of this user has it."""
    with _reservation(f"bus_{domain}_{os.getuid()}") as reserved:
        if not reserved:
            raise RunFailed(
                f"ROS domain {domain} has a run with a bus in real time already, which would take"
                " the frames of this one: wait, take another domain, or name other channels"
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
    """Reserve something in the block; the value is False if another run or user has it."""
    with ExitStack() as stack:
        try:
            lock = stack.enter_context(open(_lock_file(what), "wb", opener=_opened_in_place))
            # The lock ends with its process however that ends; the file stays and means nothing.
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError:
            yield False
        else:
            yield True


def _opened_in_place(path: str, flags: int) -> int:
    """Everybody may write into the folder of the locks: a link there is not followed.

    Nor does a pipe there hold us up. No other user may open the file: to open it is enough to lock
    it.
    """
    return os.open(path, (flags | os.O_NOFOLLOW | os.O_NONBLOCK) & ~os.O_TRUNC, 0o600)


def _blocked() -> str:
    """Name a lock file, or their folder, that is not ours to write, and its owner; else nothing."""
    for domain in _DOMAINS:
        try:
            os.close(_opened_in_place(str(_lock_file(domain)), os.O_WRONLY | os.O_CREAT))
        except OSError as error:
            file = _lock_file(domain)
            found = file if os.path.lexists(file) else file.parent
            return (
                f", or blocked: {found} belongs to user {found.lstat().st_uid} ({error.strerror})"
            )
    return ""


def _lock_file(what: object) -> Path:
    return Path(tempfile.gettempdir()) / f"ev_stack_domain_{what}.lock"


def _is_silent(domain: int) -> bool:
    """Return True if all participants' ports are free; later ones may outlive the first ones."""
    ports = (discovery_port(domain, participant) for participant in range(_PARTICIPANTS))
    for port in (_FIRST_PORT + _PORTS_PER_DOMAIN * domain, *ports):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            try:
                # On all interfaces, as participants of DDS do.
                probe.bind(("", port))
            except OSError:
                return False
    return True
