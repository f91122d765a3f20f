"""Frames by multicast, as udp_multicast of python-can writes them, on the network of one address of this machine.

python-can's own bus listens at all addresses. This one hears what was sent to its group on that network, and no more.
"""

from __future__ import annotations

import ipaddress
import select
import socket
import struct

import can
from can.interfaces.udp_multicast.utils import pack_message, unpack_message

_BUFFER = 1 << 20  # bytes for frames that nobody has taken yet: a second of a full bus
_LONGEST = 4096  # bytes of a datagram
_TIMESTAMPS = 35  # SO_TIMESTAMPNS of Linux
_ALL_GROUPS = 49  # IP_MULTICAST_ALL: also what others on this machine have joined, wherever they have
_TIME = struct.Struct("@ll")  # s, ns


class MulticastBus(can.BusABC):
    """A bus of python-can that hears itself, too; ValueError or OSError if it cannot be had."""

    def __init__(self, group: str, port: int, address: str) -> None:
        super().__init__(channel=group)
        self._to = (group, port)
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self._join(socket.inet_aton(group), ipaddress.IPv4Address(address))
        except BaseException:
            self.shutdown()
            raise

    def _join(self, group: bytes, address: ipaddress.IPv4Address) -> None:
        hops = 0 if address.is_loopback else 1
        for level, option, value in (
            (socket.SOL_SOCKET, socket.SO_REUSEADDR, 1),
            (socket.SOL_SOCKET, socket.SO_REUSEPORT, 1),
            (socket.SOL_SOCKET, socket.SO_RCVBUF, _BUFFER),
            (socket.SOL_SOCKET, _TIMESTAMPS, 1),
            (socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, hops),
            (socket.IPPROTO_IP, _ALL_GROUPS, 0),
            (socket.IPPROTO_IP, socket.IP_MULTICAST_IF, address.packed),
        ):
            self._socket.setsockopt(level, option, value)
        self._socket.bind(self._to)  # the group itself: what is sent to an address of this machine is not for us
        self._socket.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, group + address.packed)
        self._socket.setblocking(False)

    def _recv_internal(self, timeout: float | None) -> tuple[can.Message | None, bool]:
        if timeout != 0.0:
            select.select([self._socket], [], [], timeout)
        try:
            data, ((_, _, time),), _, _ = self._socket.recvmsg(_LONGEST, socket.CMSG_SPACE(_TIME.size))
        except BlockingIOError:
            return None, False
        seconds, nanoseconds = _TIME.unpack(time)
        return unpack_message(data, {"timestamp": seconds + 1e-9 * nanoseconds}, check=True), True

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        """Send a frame; OSError if it cannot be sent at once."""
        self._socket.sendto(pack_message(msg), self._to)

    def fileno(self) -> int:
        """What `select` can wait for."""
        return self._socket.fileno()

    def shutdown(self) -> None:
        """Leave the group."""
        super().shutdown()
        self._socket.close()
