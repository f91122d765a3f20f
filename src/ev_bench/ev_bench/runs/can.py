"""The CAN bus of a run: channels of its own in real time, the log of its frames in lockstep.

How it works: in real time `real_bus` finds a bus for both ends: multicast on loopback where a frame
comes back, else a hub that lasts as long as the run. In lockstep the bus is a model, and its frames
are made again for the log after the run (`frame_log`).
"""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import fields
from pathlib import Path
from typing import Any

from ev_bench.bus.parameters import CIRCUITS, LOOPBACK, BusInterface
from ev_bench.bus.socketcand_hub import HOST
from ev_bench.runs.frame_log import FrameLog
from ev_msgs_py.refusal import quoted
from ev_stack.recording.outcome import RunFailed, announce
from ev_stack.running.children import ends_with_us
from ev_stack.running.domain import own_bus
from ev_stack.scenarios.records import Run

_ENDS = ("inverter_gateway", "test_bench")
# Two for each ROS domain, so that runs at the same time do not receive the frames of each other;
# below those that Linux gives to sockets which ask for none (from 32768 on), one of which would be
# in use now and then.
_FIRST_CAN_PORT = 28111
_ECHO_PATIENCE = 0.5  # s for a frame to come back


@contextmanager
def real_bus(run: Run, domain: int, directory: Path) -> Iterator[dict[str, dict[str, Any]]]:
    """Further parameters, by name, of the nodes at both ends of a bus in real time.

    Channels without a name get one of this run alone. RunFailed if a hub is needed and does not
    start.
    """
    if not (run.realtime and all(name in run.configurations for name in _ENDS)):
        yield {}
        return
    bus = run.configurations[_ENDS[0]].parameters.bus
    _refuse_another_bus(run.configurations[_ENDS[1]].parameters.bus, bus)
    with _channels(bus, domain) as (interface, channels):
        announce(f"{run.name}: CAN over {interface}, {' and '.join(channels)}")
        names = [f"bus.channel_{circuit}" for circuit in CIRCUITS]
        given = {
            "bus.interface": interface,
            "bus.address": bus.address,
            **dict(zip(names, channels, strict=True)),
        }
        log = {"bus.log": str(directory / bus.log)} if bus.log else {}
        yield {_ENDS[0]: given | log, _ENDS[1]: given}


def _refuse_another_bus(of_bench: BusInterface, bus: BusInterface) -> None:
    """RunFailed if the bench names a bus that is not that of the gateway, which both ends get."""
    for field in fields(BusInterface):
        value, given = getattr(of_bench, field.name), getattr(bus, field.name)
        # What is at its default was not named, and follows the gateway.
        if value not in (field.default, given):
            raise RunFailed(
                f"test_bench.bus.{field.name}: {quoted(value)} is refused, expected "
                f"{quoted(given)}, as of inverter_gateway: both have its bus"
            )


@contextmanager
def _channels(bus: BusInterface, domain: int) -> Iterator[tuple[str, list[str]]]:
    """Interface and channels, those that are named or free ones."""
    named = list(bus.channels().values())
    if bus.channel_11 or bus.channel_12 or bus.interface not in ("udp_multicast", "socketcand"):
        yield bus.interface, named
        return
    if bus.interface == "udp_multicast":
        free = [
            f"{name.partition(':')[0]}:{_FIRST_CAN_PORT + 2 * domain + n}"
            for n, name in enumerate(named)
        ]
        # Before anything is sent there: all runs of a domain would have one bus.
        with own_bus(domain):
            if bus.address != LOOPBACK or _works(free[0]):
                yield bus.interface, free
                return
    with _hub() as place:
        yield "socketcand", [f"can{circuit}@{place}" for circuit in CIRCUITS]


def _works(channel: str) -> bool:
    """Check that messages to a multicast group come back."""
    from ev_bench.bus.channel import Channel
    from ev_bench.bus.opening import BusError
    from ev_msgs_py.can.frame_length import Frame

    try:
        probe = Channel("udp_multicast", channel)
    except BusError:
        return False
    try:
        probe.send(Frame(0, b""))
        end = time.monotonic() + _ECHO_PATIENCE
        # Sending may succeed where multicast does not work: only a frame that comes back shows it.
        while probe.unsent == probe.received == 0 and time.monotonic() < end:
            probe.receive()
        return probe.received > 0
    finally:
        probe.close()


@contextmanager
def _hub() -> Iterator[str]:
    """HOST:PORT of a hub that lasts as long as the block."""
    words = [sys.executable, "-m", "ev_bench.can_hub", "--port", "0"]
    with subprocess.Popen(
        words, stdout=subprocess.PIPE, text=True, preexec_fn=ends_with_us()
    ) as hub:
        try:
            assert hub.stdout is not None
            # Its first line has the port, once it listens; it is empty if the hub has ended.
            line = hub.stdout.readline().strip()
            place = line.rpartition(" ")[2]
            if not place.startswith(f"{HOST}:"):
                raise RunFailed(
                    f"the hub for CAN frames did not start: {line or 'it printed nothing'}"
                )
            yield place
        finally:
            hub.terminate()


def frame_log(run: Run, directory: Path) -> FrameLog | None:
    """The log that the gateway of a run in lockstep asks for, open; None without one.

    In real time the node that sends on the bus writes its log. RunFailed if the file cannot be
    written.
    """
    gateway = run.configurations.get("inverter_gateway")
    file = gateway.parameters.bus.log if gateway else ""
    if not file or run.realtime:
        return None
    from ev_bench.bus.channel import bus_log

    try:
        log = bus_log(str(directory / file))
    except ValueError as error:
        raise RunFailed(f"inverter_gateway.bus.log: {error}") from None
    return FrameLog(log, run.configurations["test_bench"])
