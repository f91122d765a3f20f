"""An ECU program in plain python-can: leads one drive to a torque, holds it, stops. No ROS, nothing of this project.

    python docs/examples/ecu_script.py --torque 20 --seconds 3

`--bus` is whatever can.Bus takes, such as interface=socketcan,channel=can0. Exit status 1 if the drive has a fault.
"""

import argparse
import sys
import time

import can
import cantools

HUB = "interface=socketcand,channel=can11,host=127.0.0.1,port=29536"  # ros2 run ev_sim can_hub
OPERATION_ENABLED, FAULT = 0x27, 0x08
# Statusword (bits 0 to 3, 5 and 6) -> controlword that leads on, CiA 402.
LEADS_ON = {0x40: 0x06, 0x60: 0x06, 0x21: 0x07, 0x23: 0x0F, OPERATION_ENABLED: 0x0F}


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


def main() -> int:
    """Lead the drive; the exit status."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--torque", type=float, default=20.0, help="at the shaft [N m]")
    parser.add_argument("--seconds", type=float, default=3.0, help="to hold it")
    parser.add_argument("--drive", default="Drive11", help="Drive11 is the right one, Drive12 the left one")
    parser.add_argument("--database", default="config/can/ev_bench.dbc")
    parser.add_argument("--bus", default=HUB, help="NAME=VALUE,... for can.Bus")
    given = parser.parse_args()
    database = cantools.database.load_file(given.database)
    set_point = database.get_message_by_name(f"{given.drive}_SetPoint")
    motion = database.get_message_by_name(f"{given.drive}_Motion")
    words = dict(word.split("=", 1) for word in given.bus.split(","))
    bus = can.Bus(**{name: int(value) if value.isdecimal() else value for name, value in words.items()})

    counter, heard, told, held_until = 0, 0.0, {"Statusword": 0, "Torque": 0.0, "Speed": 0.0}, None
    start = due = time.monotonic()
    while held_until is None or time.monotonic() < held_until:
        while (message := bus.recv(timeout=0.0)) is not None:
            if message.arbitration_id == motion.frame_id and message.data[0] == checksum(motion, message.data):
                told, heard = motion.decode(message.data, decode_choices=False), time.monotonic()
        now, state = time.monotonic(), int(told["Statusword"]) & 0x6F
        if state & 0x4F == FAULT or (heard and now - heard > 1.0) or now - start > 10.0 + given.seconds:
            break
        enabled = state == OPERATION_ENABLED
        if enabled and held_until is None:
            held_until = now + given.seconds
        signals = {
            "Crc": 0, "Counter": counter, "Mode": 1, "Direction": 0, "Controlword": LEADS_ON.get(state, 0x00),
            "Torque": given.torque if enabled else 0.0, "Speed": 7500, "TorqueLimit": 360,
        }  # fmt: skip
        data = bytearray(set_point.encode(signals))
        data[0] = checksum(set_point, data)
        bus.send(can.Message(arbitration_id=set_point.frame_id, data=data, is_extended_id=False))
        counter = (counter + 1) % 15
        due += 0.001
        time.sleep(max(due - time.monotonic(), 0.0))
    bus.shutdown()  # no more set-points: the drive stops by its time-out
    print(f"statusword {int(told['Statusword']):03X}h, {told['Torque']:.3f} N m, {told['Speed']:.1f} rpm")
    return 0 if int(told["Statusword"]) & 0x6F == OPERATION_ENABLED else 1


if __name__ == "__main__":
    sys.exit(main())
