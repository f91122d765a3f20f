"""An ECU program in plain python-can: resets a drive, leads it to a torque, holds it, stops. No ROS, nothing of ours.

    python docs/examples/ecu_script.py --torque 20 --seconds 3

`--bus` is whatever can.Bus takes, such as interface=socketcan,channel=can0. Exit status 1 if the
drive has a fault.
"""

import argparse
import logging
import sys
import time

import can
import cantools

HUB = "interface=socketcand,channel=can11,host=127.0.0.1,port=29536"  # ros2 run ev_bench can_hub
ENABLED, DISABLE, RESET = 0x27, 0x00, 0x80
# Statusword (bits 0 to 3, 5 and 6) -> controlword that leads on, CiA 402.
LEADS_ON = {0x40: 0x06, 0x60: 0x06, 0x21: 0x07, 0x23: 0x0F, ENABLED: 0x0F}
CYCLE, SILENCE = 0.001, 1.0  # s; from one set-point to the next, without feedback


def crc8(data: bytes) -> int:
    """CRC-8 SAE J1850 with start value and final XOR 0, as AUTOSAR E2E profile 1 has it."""
    crc = 0
    for byte in data:
        crc ^= byte
        for _ in range(8):
            crc = (crc << 1) ^ (0x11D if crc & 0x80 else 0)
    return crc


def checksum(message, data: bytes) -> int:
    """Over the data id, low byte first, and everything behind the checksum."""
    identifier = int(message.dbc.attributes["E2EDataId"].value)
    return crc8(identifier.to_bytes(2, "little") + data[1:])


def opened(text: str) -> can.BusABC:
    """The bus of --bus: NAME=VALUE,... for can.Bus."""
    # It would warn of every message that comes in two pieces, which is how streams are.
    logging.getLogger("can.interfaces.socketcand").setLevel(logging.ERROR)
    words = dict(word.split("=", 1) for word in text.split(","))
    return can.Bus(
        **{name: int(value) if value.isdecimal() else value for name, value in words.items()}
    )


class Drive:
    """A drive by its newest feedback; each cycle sends a set-point."""

    def __init__(self, bus, database, name: str) -> None:
        self.bus = bus
        frames = (
            database.get_message_by_name(f"{name}_{kind}")
            for kind in ("SetPoint", "Motion", "Faults")
        )
        self.set_point, self.motion, self.faults = frames
        self.counter, self.due, self.heard = 0, time.monotonic(), 0.0
        self.statusword, self.torque, self.speed, self.error = 0, 0.0, 0.0, "no fault"

    @property
    def state(self) -> int:
        """The bits of the statusword that make up the state."""
        return self.statusword & 0x6F

    @property
    def is_faulty(self) -> bool:
        """Whether it is in a fault, or on the way into one."""
        return self.statusword & 0x48 == 0x08

    @property
    def is_silent(self) -> bool:
        """Whether no valid feedback has come for a while."""
        return time.monotonic() - self.heard > SILENCE

    def receive(self) -> None:
        """Take all frames that wait."""
        while (message := self.bus.recv(timeout=0.0)) is not None:
            if message.arbitration_id == self.motion.frame_id and message.data[0] == checksum(
                self.motion, message.data
            ):
                told = self.motion.decode(message.data, decode_choices=False)
                self.statusword, self.torque, self.speed = (
                    int(told["Statusword"]),
                    told["Torque"],
                    told["Speed"],
                )
                self.heard = time.monotonic()
            if message.arbitration_id == self.faults.frame_id and message.data[0] == checksum(
                self.faults, message.data
            ):
                # by the names of the database
                self.error = str(self.faults.decode(message.data)["ErrorCode"])

    def cycle(self, controlword: int, torque: float = 0.0) -> None:
        """Send a set-point, wait for the next cycle, and take what has come."""
        signals = {
            "Crc": 0, "Counter": self.counter, "Mode": 1, "Direction": 0, "Controlword": controlword,
            "Torque": torque, "Speed": 7500, "TorqueLimit": 360,
        }  # fmt: skip
        data = bytearray(self.set_point.encode(signals))
        data[0] = checksum(self.set_point, data)
        self.bus.send(
            can.Message(arbitration_id=self.set_point.frame_id, data=data, is_extended_id=False)
        )
        self.counter = (self.counter + 1) % 15
        self.due += CYCLE
        time.sleep(max(self.due - time.monotonic(), 0.0))
        self.receive()

    def follow(self, ends, seconds: float, torque: float = 0.0) -> bool:
        """Lead on by the states until something holds; False where it does not within some time."""
        until = time.monotonic() + seconds
        while not ends() and time.monotonic() < until:
            self.cycle(LEADS_ON.get(self.state, DISABLE), torque if self.state == ENABLED else 0.0)
        return ends()

    def reset(self) -> None:
        """The reset sequence: no torque and no command, then the reset bit rises."""
        for word in (DISABLE, RESET):
            for _ in range(50):
                self.cycle(word)

    def stop(self) -> None:
        """Torque away, then voltage; a drive that is disabled does not wait for set-points."""
        self.follow(lambda: abs(self.torque) < 1.0 or self.state != ENABLED, 0.1)
        for _ in range(10):
            self.cycle(DISABLE)


def lead(drive: Drive, torque: float, seconds: float) -> str:
    """Reset, enable, hold; what was in the way, in one line."""
    until = time.monotonic() + 10.0
    while drive.statusword == 0 and time.monotonic() < until:
        drive.cycle(DISABLE)
    if drive.statusword == 0:
        return "it sends nothing"
    if drive.is_faulty:
        drive.reset()
    enabled = drive.follow(
        lambda: drive.state == ENABLED or drive.is_faulty or drive.is_silent, 10.0
    )
    if enabled and drive.state == ENABLED:
        drive.follow(lambda: drive.state != ENABLED or drive.is_silent, seconds, torque)
    if drive.is_silent:
        return "its feedback stays away"
    return (
        ""
        if drive.state == ENABLED
        else "it is in a fault"
        if drive.is_faulty
        else "it is not enabled"
    )


def main() -> int:
    """Lead the drive; the exit status."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--torque", type=float, default=20.0, help="at the shaft [N m]")
    parser.add_argument("--seconds", type=float, default=3.0, help="to hold it")
    parser.add_argument(
        "--drive", default="Drive11", help="Drive11 is the right one, Drive12 the left one"
    )
    parser.add_argument("--database", default="config/can/ev_bench.dbc")
    parser.add_argument("--bus", default=HUB, help="NAME=VALUE,... for can.Bus")
    given = parser.parse_args()
    with opened(given.bus) as bus:
        drive = Drive(bus, cantools.database.load_file(given.database), given.drive)
        try:
            trouble = lead(drive, given.torque, given.seconds)
            print(
                f"statusword {drive.statusword:03X}h, {drive.torque:.3f} N m, {drive.speed:.1f} rpm"
            )
        finally:
            drive.stop()
    if trouble:
        print(f"{given.drive}: {trouble}; its first fault: {drive.error}")
    return 1 if trouble else 0


if __name__ == "__main__":
    sys.exit(main())
