"""The sockets that this process holds, as the kernel lists them."""

from __future__ import annotations

import ipaddress
import os
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

_LISTS = ("tcp", "tcp6", "udp", "udp6", "udplite", "udplite6", "raw", "raw6")


class Socket(NamedTuple):
    """One socket with its own address and port."""

    protocol: str
    address: ipaddress.IPv4Address | ipaddress.IPv6Address
    port: int


def sockets_of(process: int | str = "self") -> list[Socket]:
    """The internet sockets of a process."""
    held = set(_inodes(process))
    return [
        each for protocol in _LISTS for inode, each in _listed(process, protocol) if inode in held
    ]


def _inodes(process: int | str) -> Iterator[str]:
    folder = Path(f"/proc/{process}/fd")
    for descriptor in os.listdir(folder):
        try:
            target = os.readlink(folder / descriptor)
        except FileNotFoundError:
            continue  # the descriptor of the listing itself
        if target.startswith("socket:["):
            yield target[len("socket:[") : -1]


def _listed(process: int | str, protocol: str) -> Iterator[tuple[str, Socket]]:
    for line in Path(f"/proc/{process}/net/{protocol}").read_text().splitlines()[1:]:
        words = line.split()
        address, port = words[1].split(":")
        yield words[9], Socket(protocol, _address(address), int(port, 16))


def _address(text: str) -> ipaddress.IPv4Address | ipaddress.IPv6Address:
    """The kernel prints words of 32 bits in the byte order of the machine."""
    words = [bytes.fromhex(text[i : i + 8])[::-1] for i in range(0, len(text), 8)]
    return ipaddress.ip_address(b"".join(words))
