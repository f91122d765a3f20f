"""Opening a channel of python-can; what is wrong is one clear line."""

from __future__ import annotations

import ipaddress
import logging
import socket
from typing import Any

import can

from ev_msgs_py.can.bus_parameters import LOOPBACK
from ev_msgs_py.can.multicast_bus import MulticastBus
from ev_msgs_py.parameters.shown import quoted

_PATIENCE = 1.0  # s for a hub to answer


class BusError(RuntimeError):
    """A channel that cannot be opened; the message names interface, channel and reason."""


def open_channel(interface: str, channel: str, address: str = LOOPBACK) -> can.BusABC:
    """A bus of python-can that does not hear itself, but for udp_multicast; BusError if it cannot be had.

    `address` is that of this machine in the network of a multicast group; on loopback a hub is on this machine, too.
    """
    try:
        return _open(interface, channel, address)
    except (can.CanError, can.CanInterfaceNotImplementedError, OSError, ValueError) as error:
        reason = (error.__cause__ or error) if isinstance(error, can.CanInitializationError) else error
        text = getattr(reason, "strerror", None) or str(reason)
        raise BusError(f"CAN interface {interface}, channel {channel}: {' '.join(text.split())}") from None


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
            raise ValueError(f"host {quoted(host)} is refused, allowed is {LOOPBACK} unless bus.address is another one")
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
    # What could not be opened would warn, behind the reason why, that nobody has closed it.
    logging.getLogger("can.bus").setLevel(logging.ERROR)
    return can.Bus(channel=channel, interface=interface, ignore_config=True, **more)


def _split(text: str, sign: str, form: str) -> tuple[str, str]:
    before, found, after = text.partition(sign)
    if not (before and found and after):
        raise ValueError(f"is not of the form {form}")
    return before, after


def _port(text: str) -> int:
    if not text.isdecimal() or not 0 < int(text) < 65536:
        raise ValueError(f"port {quoted(text)} is refused, allowed is 1 to 65535")
    return int(text)
