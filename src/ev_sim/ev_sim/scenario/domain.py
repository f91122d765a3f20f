"""A ROS domain that nobody else on this machine uses."""

from __future__ import annotations

import fcntl
import socket
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

_DOMAINS = range(1, 102)  # those that are safe on every operating system
_FIRST_PORT, _PORTS_PER_DOMAIN = 7400, 250  # of DDS: multicast discovery of a domain
_UNICAST = 10  # offset of the first participant's port


class NoFreeDomain(RuntimeError):
    """All domains are in use."""


@contextmanager
def free_domain() -> Iterator[int]:
    """A domain id without participants, reserved against other runs of this kind until the end of the block."""
    for domain in _DOMAINS:
        with (Path(tempfile.gettempdir()) / f"ev_stack_domain_{domain}.lock").open("w") as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except OSError:
                continue
            if _is_silent(domain):
                yield domain
                return
    raise NoFreeDomain(f"all ROS domains from {_DOMAINS[0]} to {_DOMAINS[-1]} are in use")


def _is_silent(domain: int) -> bool:
    """Whether the ports of the first participant and of discovery can be had."""
    base = _FIRST_PORT + _PORTS_PER_DOMAIN * domain
    for port in (base, base + _UNICAST):
        with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as probe:
            try:
                probe.bind(("", port))
            except OSError:
                return False
    return True
