"""Where the processes of a ROS domain listen for datagrams."""

from __future__ import annotations

import os
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

_FIRST, _OF_A_DOMAIN = 7400, 250  # as DDSI-RTPS has them


def ports(belongs: Callable[[int], bool]) -> list[int]:
    """UDP ports of this domain at which processes with such numbers listen."""
    sockets: set[str] = set()
    for entry in Path("/proc").glob("[0-9]*/fd/*"):
        if belongs(int(entry.parts[2])):
            with suppress(OSError):
                sockets.add(entry.readlink().name)
    first = _FIRST + _OF_A_DOMAIN * int(os.environ.get("ROS_DOMAIN_ID", "0"))
    lines = [line.split() for line in Path("/proc/net/udp").read_text().splitlines()[1:]]
    found = {
        int(line[1].partition(":")[2], 16) for line in lines if f"socket:[{line[9]}]" in sockets
    }
    return sorted(found & set(range(first, first + _OF_A_DOMAIN)))
