"""An inverter in plain python-can, in the place of ours: one drive, states by CiA 402, torque of first order. No ROS.

    python docs/examples/own_inverter.py

`--bus` is whatever can.Bus takes, such as interface=socketcan,channel=can0. Ends with Ctrl-C, or
after --seconds.
"""

import argparse
import time
from contextlib import suppress

import can
import cantools
from ecu_script import HUB, checksum, opened

DISABLED, READY, SWITCHED_ON, ENABLED, FAULT = 0x40, 0x21, 0x23, 0x27, 0x08  # statusword


def next_state(state: int, control: int, reset: bool) -> int:
    """States of CiA 402 without pre-charge and quick stop: both simply disable."""
    if state == FAULT:
        return DISABLED if reset else FAULT
    if control & 0x06 != 0x06:
        return DISABLED
    if control & 0x01 == 0:
        return READY
    return {READY: SWITCHED_ON, SWITCHED_ON: ENABLED if control & 0x08 else SWITCHED_ON,
            ENABLED: ENABLED if control & 0x08 else SWITCHED_ON}.get(state, DISABLED)  # fmt: skip


class Drive:
    """What lasts between two cycles, and the frames of both directions."""

    def __init__(self, database, name: str, timeout: float) -> None:
        self.timeout = timeout
        self.set_point = database.get_message_by_name(f"{name}_SetPoint")
        self.feedback = [
            (database.get_message_by_name(f"{name}_{kind}"), [0]) for kind in ("Motion", "Faults")
        ]
        self.state, self.torque, self.heard, self.command = (
            DISABLED,
            0.0,
            0.0,
            {"Controlword": 0, "Torque": 0.0},
        )
        self.last_counter, self.reset, self.timed_out = -1, False, False

    def take(self, message: can.Message) -> None:
        """A set-point counts if its checksum is right and its counter has gone on by 1 to 3."""
        data = bytes(message.data)
        if message.arbitration_id != self.set_point.frame_id or len(data) != 8:
            return
        if data[0] != checksum(self.set_point, data):
            return
        step, self.last_counter = ((data[1] & 0x0F) - self.last_counter) % 15, data[1] & 0x0F
        if 1 <= step <= 3:
            command = self.set_point.decode(data, decode_choices=False)
            risen = int(command["Controlword"]) & ~int(self.command["Controlword"]) & 0x80
            self.reset = self.reset or (bool(risen) and command["Torque"] == 0)
            self.command, self.heard = command, time.monotonic()

    def advance(self, period: float) -> None:
        """No torque without a fresh set-point: that is a fault, which lasts until the reset."""
        if time.monotonic() - self.heard > self.timeout and self.state not in (DISABLED, FAULT):
            self.state, self.timed_out = FAULT, True
        else:
            self.state = next_state(self.state, int(self.command["Controlword"]), self.reset)
        if self.state != FAULT:
            self.timed_out = False
        self.reset = False
        limit = float(self.command.get("TorqueLimit", 0.0))
        wanted = min(max(float(self.command["Torque"]), -limit), limit)
        self.torque = (
            self.torque + (wanted - self.torque) * period / (period + 0.002)
            if self.state == ENABLED
            else 0.0
        )

    def frames(self, tick: int) -> list[can.Message]:
        """Motion each millisecond, faults each ten."""
        found = []
        for (message, counter), every in zip(self.feedback, (1, 10), strict=True):
            if tick % every:
                continue
            values = {signal.name: 0 for signal in message.signals} | {"Counter": counter[0]}
            if every == 1:
                values |= {"Torque": self.torque, "Statusword": self.state | 0x200}
            elif self.timed_out:
                values |= {"CommandTimeout": 1, "ErrorCode": 0x8130}
            data = bytearray(message.encode(values, strict=False))
            data[0] = checksum(message, data)
            counter[0] = (counter[0] + 1) % 15
            found.append(
                can.Message(arbitration_id=message.frame_id, data=data, is_extended_id=False)
            )
        return found


def main() -> None:
    """Take set-points, advance and answer, each millisecond."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument(
        "--drive", default="Drive11", help="Drive11 is the right one, Drive12 the left one"
    )
    parser.add_argument("--database", default="config/can/ev_bench.dbc")
    parser.add_argument("--bus", default=HUB, help="NAME=VALUE,... for can.Bus")
    parser.add_argument(
        "--timeout", type=float, default=0.01, help="s without a valid set-point: fault"
    )
    parser.add_argument("--seconds", type=float, default=float("inf"))
    given = parser.parse_args()
    drive = Drive(cantools.database.load_file(given.database), given.drive, given.timeout)
    start, tick = time.monotonic(), 0
    with opened(given.bus) as bus:
        while time.monotonic() - start < given.seconds:
            while (message := bus.recv(timeout=0.0)) is not None:
                drive.take(message)
            drive.advance(0.001)
            tick += 1
            for frame in drive.frames(tick):
                bus.send(frame)
            time.sleep(max(start + 0.001 * tick - time.monotonic(), 0.0))


if __name__ == "__main__":
    with suppress(KeyboardInterrupt):
        main()
