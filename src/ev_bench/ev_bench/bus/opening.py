"""Opening a channel of python-can, also by multicast on one address, with errors in one line.

Frames by multicast, as udp_multicast of python-can writes them, on the network of one address of
this machine. python-can's own bus listens at all addresses. This one receives what was sent to its
group on that network alone.
"""

from __future__ import annotations

import ipaddress
import logging
import select
import socket
import struct
from typing import Any

import can
from can.interfaces.udp_multicast.utils import pack_message, unpack_message

from ev_bench.bus.parameters import LOOPBACK
from ev_msgs_py.refusal import quoted

_BUFFER = 1 << 20  # bytes for frames that are not taken yet: a second of a full bus
_LONGEST = 4096  # bytes of a datagram
_TIMESTAMPS = 35  # SO_TIMESTAMPNS of Linux
# IP_MULTICAST_ALL: also what others on this machine have joined, wherever they have
_ALL_GROUPS = 49
_TIME = struct.Struct("@ll")  # s, ns
_PATIENCE = 1.0  # s for a hub to answer


class MulticastBus(can.BusABC):
    """Open a bus of python-can that also receives its own frames.

    ValueError or OSError otherwise.
    """

    def __init__(self, group: str, port: int, address: str) -> None:
        super().__init__(channel=group)
        self._to = (group, port)
        self._socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        try:
            self._join(socket.inet_aton(group), ipaddress.IPv4Address(address))
        # Whatever interrupts it, a socket that is half set up does not stay open.
        except BaseException:
            self.shutdown()
            raise

    def _join(self, group: bytes, address: ipaddress.IPv4Address) -> None:
        hops = 0 if address.is_loopback else 1
        for level, option, value in (
            # All nodes of this machine listen at the same port of the same group.
            (socket.SOL_SOCKET, socket.SO_REUSEADDR, 1),
            (socket.SOL_SOCKET, socket.SO_REUSEPORT, 1),
            (socket.SOL_SOCKET, socket.SO_RCVBUF, _BUFFER),
            # The kernel stamps a datagram as it comes: that is where latency begins to count.
            (socket.SOL_SOCKET, _TIMESTAMPS, 1),
            # With 0 hops no frame leaves this machine, with 1 none leaves its network.
            (socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, hops),
            (socket.IPPROTO_IP, _ALL_GROUPS, 0),
            (socket.IPPROTO_IP, socket.IP_MULTICAST_IF, address.packed),
        ):
            self._socket.setsockopt(level, option, value)
        # the group itself: what is sent to an address of this machine is not for us
        self._socket.bind(self._to)
        self._socket.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, group + address.packed)
        self._socket.setblocking(False)

    def _recv_internal(self, timeout: float | None) -> tuple[can.Message | None, bool]:
        if timeout != 0.0:
            select.select([self._socket], [], [], timeout)
        try:
            data, ((_, _, time),), _, _ = self._socket.recvmsg(
                _LONGEST, socket.CMSG_SPACE(_TIME.size)
            )
        except BlockingIOError:
            return None, False
        seconds, nanoseconds = _TIME.unpack(time)
        # True: no filters are set, so python-can has nothing to filter.
        return unpack_message(data, {"timestamp": seconds + 1e-9 * nanoseconds}, check=True), True

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        """Send a frame; OSError if it cannot be sent at once."""
        self._socket.sendto(pack_message(msg), self._to)

    def fileno(self) -> int:
        """Descriptor for `select`."""
        return self._socket.fileno()

    def shutdown(self) -> None:
        """Leave the group."""
        super().shutdown()
        self._socket.close()


class BusError(RuntimeError):
    """A channel that cannot be opened; the message names interface, channel and reason."""


def open_channel(interface: str, channel: str, address: str = LOOPBACK) -> can.BusABC:
    """Open a bus of python-can that does not receive its own frames, except by udp_multicast.

    `address` is that of this machine in the network of a multicast group; on loopback a hub is on
    this machine, too.
    """
    try:
        return _open(interface, channel, address)
    except (can.CanError, can.CanInterfaceNotImplementedError, OSError, ValueError) as error:
        reason = (
            # python-can wraps the error of the system; the cause is the shorter line.
            (error.__cause__ or error) if isinstance(error, can.CanInitializationError) else error
        )
        text = getattr(reason, "strerror", None) or str(reason)
        raise BusError(
            f"CAN interface {interface}, channel {channel}: {' '.join(text.split())}"
        ) from None


def _open(interface: str, channel: str, address: str) -> can.BusABC:
    if interface == "udp_multicast":
        group, port = _split(channel, ":", "GROUP:PORT")
        if not ipaddress.IPv4Address(group).is_multicast:
            raise ValueError(f"{group} is no multicast address, such as 239.192.11.11")
        return MulticastBus(group, _port(port), address)
    if interface == "socketcand":
        name, place = _split(channel, "@", "NAME@HOST:PORT")
        host, port = _split(place, ":", "NAME@HOST:PORT")
        if address == LOOPBACK and not _is_here(host):
            raise ValueError(
                f"host {quoted(host)} is refused, expected {LOOPBACK} unless bus.address is"
                " another one"
            )
        # It would warn of every message that comes in two pieces, which is how streams are.
        logging.getLogger("can.interfaces.socketcand").setLevel(logging.ERROR)
        # python-can would try for 10 s, at full speed
        socket.create_connection((host, _port(port)), _PATIENCE).close()
        return _bus(interface, name, host=host, port=_port(port), tcp_tune=True)
    return _bus(interface, channel)


def _is_here(host: str) -> bool:
    try:
        return ipaddress.ip_address(host).is_loopback
    except ValueError:
        return host == "localhost"


def _bus(interface: str, channel: str, **more: Any) -> can.BusABC:
    # What could not be opened would warn, behind the reason why, that it was not closed.
    logging.getLogger("can.bus").setLevel(logging.ERROR)
    return can.Bus(channel=channel, interface=interface, ignore_config=True, **more)


def _split(text: str, sign: str, form: str) -> tuple[str, str]:
    before, found, after = text.partition(sign)
    if not (before and found and after):
        raise ValueError(f"is not of the form {form}")
    return before, after


def _port(text: str) -> int:
    if not text.isdecimal() or not 0 < int(text) < 65536:
        raise ValueError(f"port {quoted(text)} is refused, expected 1 to 65535")
    return int(text)
