"""Set-points at 1 kHz on two channels between two processes, beside bare python-can in the same run.

    python benchmarks/can_latency.py [--seconds N] [--json FILE]

A controller sends a set-point on each channel every millisecond: packed, counted and protected. The
device checks and unpacks it and answers with its motion frame, which the controller checks and
unpacks. Each second of that is followed by a second in which python-can alone carries the same
traffic on channels of its own, 8 bytes there and back, nothing looked at. Times are round trips
from before `send` to after the answer was read.
"""

from __future__ import annotations

import argparse
import json
import os
import platform
import select
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import can

from ev_bench.bus.channel import Channel
from ev_bench.bus.checking import INITIAL, TOLERANCES, CheckState, check, is_valid
from ev_bench.bus.opening import open_channel
from ev_bench.bus.parameters import load_database
from ev_msgs_py.can.database import FrameLayout
from ev_msgs_py.can.frame_length import Frame
from ev_msgs_py.can.payload import next_counter

PERIOD = 0.001  # s
BLOCK = 1.0  # s of one kind of traffic
PING, PONG, STOP = 0x7F0, 0x7F1, 0x7FF  # identifiers that the database does not have
STEP = 1 / 32  # N m, one step of the torque, by which a set-point and its answer are known
NUMBERS = 32000  # of them
DEVICES = {"11": "Drive11", "12": "Drive12"}
INTERFACE = "udp_multicast"
CHANNELS = {"11": "239.192.11.21:43121", "12": "239.192.11.22:43122"}
BARE_CHANNELS = ("239.192.11.23:43123", "239.192.11.24:43124")


class End(NamedTuple):
    """One end of one channel: what it sends, what it hears, and how it judges that."""

    sent: FrameLayout
    heard: FrameLayout
    channel: Channel
    check: CheckState

    def judged(self, frame: Frame) -> dict[str, float] | None:
        """The signals of a frame, None if it is not valid."""
        payload = int.from_bytes(frame.data, "little")
        status = check(TOLERANCES, self.check, payload, self.heard.length, self.heard.data_id)
        return self.heard.values(payload) if is_valid(status) or status == INITIAL else None


def ends(sends: str, hears: str) -> list[End]:
    """Both channels of the controller, or of the device."""
    database = load_database()
    return [
        End(
            database[f"{device}_{sends}"],
            database[f"{device}_{hears}"],
            Channel(INTERFACE, CHANNELS[circuit]),
            CheckState(),
        )
        for circuit, device in DEVICES.items()
    ]


def bare_buses() -> list[can.BusABC]:
    """The channels of python-can alone."""
    return [open_channel(INTERFACE, name) for name in BARE_CHANNELS]


def close(own: list[End], bare: list[can.BusABC]) -> None:
    """Leave all channels."""
    for end in own:
        end.channel.close()
    for bus in bare:
        bus.shutdown()


def serve() -> None:
    """The device: answers until it is told to stop, then prints what it has heard."""
    own, counters, lost, refused, heard = ends("Motion", "SetPoint"), [0, 0], 0.0, 0, 0
    bare = bare_buses()
    handles = {end.channel.fileno(): (place, None) for place, end in enumerate(own)}
    handles |= {bus.fileno(): (place, bus) for place, bus in enumerate(bare)}
    print("ready", flush=True)
    while True:
        for handle in select.select(list(handles), [], [], 30.0)[0]:
            place, bus = handles[handle]
            if bus is not None:
                message = bus.recv(timeout=0.0)
                if message is not None and message.arbitration_id == PING:
                    bus.send(
                        can.Message(arbitration_id=PONG, data=message.data, is_extended_id=False)
                    )
                continue
            end = own[place]
            while (frame := end.channel.receive()) is not None:
                if frame.identifier == STOP:
                    print(
                        json.dumps({"heard": heard, "lost": lost, "refused": refused}), flush=True
                    )
                    close(own, bare)
                    return
                if frame.identifier != end.heard.identifier:
                    continue
                values = end.judged(frame)
                heard += 1
                lost += end.check.lost_data
                if values is None:
                    refused += 1
                    continue
                answer = {
                    "CommandCheck": 0.0,
                    "Torque": values["Torque"],
                    "Speed": 0.0,
                    "Statusword": 0.0,
                }
                end.channel.send(Frame(end.sent.identifier, end.sent.pack(answer, counters[place])))
                counters[place] = next_counter(counters[place])


class Round:
    """One kind of traffic: sends on both channels each period, and notes when answers come."""

    def __init__(
        self, send: Callable[[int, int], None], read: Callable[[int], list[int]], handles: list[int]
    ) -> None:
        self._send, self._read, self._handles = send, read, handles
        self.sent = self.answered = 0
        self.times: list[float] = []
        self._under_way: dict[tuple[int, int], float] = {}
        self._number = 0

    def block(self, seconds: float) -> None:
        """Go on for some time, and then wait a moment for the last answers."""
        start = time.perf_counter()
        for count in range(round(seconds / PERIOD)):
            self._number = (self._number + 1) % NUMBERS
            for place in range(len(self._handles)):
                self._under_way[place, self._number] = time.perf_counter()
                self._send(place, self._number)
                self.sent += 1
            self._listen(start + (count + 1) * PERIOD)
        self._listen(time.perf_counter() + 0.05)
        self._under_way.clear()

    def _listen(self, until: float) -> None:
        while (left := until - time.perf_counter()) > 0.0:
            for handle in select.select(self._handles, [], [], left)[0]:
                place = self._handles.index(handle)
                for number in self._read(place):
                    began = self._under_way.pop((place, number), None)
                    if began is not None:
                        self.times.append(time.perf_counter() - began)
                        self.answered += 1

    def result(self) -> dict[str, float]:
        """Counts, and round trips [us]."""
        ordered = sorted(self.times)
        return {
            "sent": self.sent,
            "not_answered": self.sent - self.answered,
            "median_us": 1e6 * ordered[len(ordered) // 2],
            "p99_9_us": 1e6 * ordered[min(int(0.999 * len(ordered)), len(ordered) - 1)],
            "largest_us": 1e6 * ordered[-1],
        }


def protected_round(own: list[End]) -> Round:
    """Set-points and motion frames, as the nodes send and read them."""
    counters = [0, 0]
    values = {
        "Mode": 1.0,
        "Direction": 0.0,
        "Controlword": 15.0,
        "Speed": 7500.0,
        "TorqueLimit": 360.0,
    }

    def send(place: int, number: int) -> None:
        end = own[place]
        torque = STEP * (number - NUMBERS // 2)
        end.channel.send(
            Frame(end.sent.identifier, end.sent.pack(values | {"Torque": torque}, counters[place]))
        )
        counters[place] = next_counter(counters[place])

    def read(place: int) -> list[int]:
        end, found = own[place], []
        while (frame := end.channel.receive()) is not None:
            if (
                frame.identifier == end.heard.identifier
                and (heard := end.judged(frame)) is not None
            ):
                found.append(round(heard["Torque"] / STEP) + NUMBERS // 2)
        return found

    return Round(send, read, [end.channel.fileno() for end in own])


def bare_round(buses: list[can.BusABC]) -> Round:
    """The same traffic by python-can alone."""

    def send(place: int, number: int) -> None:
        data = number.to_bytes(8, "little")
        buses[place].send(can.Message(arbitration_id=PING, data=data, is_extended_id=False))

    def read(place: int) -> list[int]:
        message = buses[place].recv(timeout=0.0)
        if message is None or message.arbitration_id != PONG:
            return []
        return [int.from_bytes(message.data, "little")]

    return Round(send, read, [bus.fileno() for bus in buses])


def measure(seconds: float) -> dict[str, Any]:
    """Both kinds of traffic in turn, `seconds` of each."""
    words = [sys.executable, __file__, "--serve"]
    with subprocess.Popen(words, stdout=subprocess.PIPE, text=True) as device:
        assert device.stdout is not None
        assert device.stdout.readline() == "ready\n"
        own, bare = ends("SetPoint", "Motion"), bare_buses()
        ours, theirs = protected_round(own), bare_round(bare)
        left = seconds
        while left > 0.0:
            for kind in (ours, theirs):
                kind.block(min(BLOCK, left))
            left -= BLOCK
        own[0].channel.send(Frame(STOP, b""))
        told = json.loads(device.stdout.readline())
        close(own, bare)
    return {"protected": ours.result(), "bare": theirs.result(), "device": told}


def main() -> None:
    """Print both and their ratio and, if asked for, write them as JSON."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument(
        "--seconds", type=float, default=10.0, help="of each kind of traffic; default 10"
    )
    parser.add_argument("--json", type=Path, help="write the result to this file")
    parser.add_argument("--serve", action="store_true", help=argparse.SUPPRESS)
    given = parser.parse_args()
    if given.serve:
        serve()
        return
    result = measure(given.seconds)
    ours, bare = result["protected"], result["bare"]
    print(f"{'':12} {'sent':>8} {'not answered':>13} {'median':>10} {'99.9 %':>10} {'largest':>10}")
    for name, row in (("set-points", ours), ("bare", bare)):
        times = "".join(f" {row[key]:7.0f} us" for key in ("median_us", "p99_9_us", "largest_us"))
        print(f"{name:12} {row['sent']:8d} {row['not_answered']:13d}{times}")
    print(
        f"median {ours['median_us'] / bare['median_us']:.2f}, 99.9 %"
        f" {ours['p99_9_us'] / bare['p99_9_us']:.2f} of bare"
    )
    if given.json:
        machine = {
            "machine": platform.processor() or platform.machine(),
            "python": platform.python_version(),
            "cores": len(os.sched_getaffinity(0)),
            "interface": INTERFACE,
            "seconds": given.seconds,
        }
        given.json.write_text(json.dumps(machine | result, indent=2) + "\n")


if __name__ == "__main__":
    main()
