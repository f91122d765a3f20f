"""A stranger on another machine: tries the ports of an address.

It reads one JSON line at a time from standard input: [ADDRESS, TCP_PORTS, UDP_PORTS] is answered by
the ports that do not refuse, [GROUP, PORT, HEX] by [] when it was sent.
"""

from __future__ import annotations

import errno
import json
import select
import socket
import sys
import time

PATIENCE = 3.0  # s without a refusal, which is not sent for every datagram
# s: on a busy machine a refusal is late, and none would look like an open port
OF_A_CONNECTION = 60.0


def is_open(address: str, port: int) -> bool:
    """Return True if a connection is not refused."""
    with socket.socket() as caller:
        caller.settimeout(OF_A_CONNECTION)
        return caller.connect_ex((address, port)) != errno.ECONNREFUSED


def not_refused(address: str, ports: list[int]) -> list[int]:
    """The ports at which datagrams may have been taken."""
    callers = {}
    for port in ports:
        caller = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        caller.connect((address, port))
        callers[caller] = port
    heard, deadline = [], time.monotonic() + PATIENCE
    while callers and time.monotonic() < deadline:
        for caller in list(callers):
            try:
                caller.send(b"stranger")
                select.select([caller], [], [], 0.01)
                caller.recv(1000, socket.MSG_DONTWAIT)
                heard.append(callers.pop(caller))
            except ConnectionRefusedError:
                del callers[caller]
                deadline = time.monotonic() + PATIENCE
            except BlockingIOError:
                pass
    return [*heard, *callers.values()]


def send_to_group(group: str, port: int, datagram: bytes) -> None:
    """Send a multicast datagram over at most four routers."""
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as sender:
        sender.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 4)
        sender.sendto(datagram, (group, port))


if __name__ == "__main__":
    for asked in sys.stdin:
        first, *others = json.loads(asked)
        if isinstance(others[0], int):
            send_to_group(first, others[0], bytes.fromhex(others[1]))
            answer = []
        else:
            answer = [f"tcp {port}" for port in others[0] if is_open(first, port)]
            answer += [f"udp {port}" for port in not_refused(first, others[1])]
        print(json.dumps(answer), flush=True)
