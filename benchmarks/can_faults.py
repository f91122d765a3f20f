"""Every fault of the bus and the inverters, seeded: how soon the torque is gone, and that only a reset clears it.

    python benchmarks/can_faults.py [--seeds N] [--fuzz N] [--json FILE]

Gateway and inverters as they are in the nodes, on two channels without loss, cycle by cycle of 1
ms. In each trial both drives have a random torque, and one fault is put into one of them at a
random instant. Its torque must be exactly zero within one time-out and one bus cycle; the fault
must be named on the bus and in the diagnosis, and stay when its cause is gone, so that enabling is
refused; the other drive must keep its torque; after the reset sequence both must run again. `--fuzz
N` sends N random frames and N frames of random content under known identifiers to both ends.
"""

from __future__ import annotations

import argparse
import json
import random
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from ev_bench.bus.parameters import load_database
from ev_bench.inverter.circuit_station import CircuitStation
from ev_bench.inverter.device import CircuitParameters, Injected, Inverter
from ev_bench.inverter_gateway.gateway import GatewayParameters
from ev_bench.inverter_gateway.panel import diagnosis
from ev_bench.inverter_gateway.station import GatewayStation
from ev_core.parameters.record import fill, numbers
from ev_core.parameters.values import build
from ev_msgs_py.can.database import Database
from ev_msgs_py.can.drive_states import OPERATION_ENABLED
from ev_msgs_py.can.frame_length import Frame
from ev_msgs_py.can.frames import DRIVES, TORQUE_MODE

CYCLE = 1  # ms
TIMEOUT = 10  # ms, of set-points and of feedback
# ohm, so that enabling takes 30 ms instead of 800
QUICK_CHARGE = {"drive.dc_link.precharge_resistance": 20.0}


class Rig:
    """Both ends of both channels; `on_wire` may drop or change a set-point frame before it arrives."""

    def __init__(self, database: Database) -> None:
        self.database = database
        self.gateway = GatewayStation(database, GatewayParameters())
        parameters = build(CircuitParameters, QUICK_CHARGE)
        self.circuits = {name: CircuitStation(database, name, parameters) for name in ("11", "12")}
        self.torque = dict.fromkeys(DRIVES, 0.0)
        self.silent = False  # the controller behind the gateway
        self.on_wire: Callable[[Frame], Frame | None] = lambda frame: frame
        self.heartbeat: dict[str, float] = {}
        self._sent: list[tuple[str, Frame]] = []
        self._life_sign = database["Ecu_Heartbeat"]

    def tick(self) -> None:
        """One cycle: frames arrive a cycle after they were sent, in either direction at most one."""
        for circuit, frame in self._sent:
            arrived = self.on_wire(frame)
            if arrived is not None:
                self.circuits[circuit].receive(arrived)
            if frame.identifier == self._life_sign.identifier:
                self.heartbeat = self._life_sign.values(int.from_bytes(frame.data, "little"))
        for circuit, station in self.circuits.items():
            for frame in station.step():
                self.gateway.receive(circuit, frame)
        if not self.silent:
            for name, torque in self.torque.items():
                self.gateway.command(name, TORQUE_MODE, torque)
        self._sent = self.gateway.step()

    def twin(self) -> Rig:
        """Another one in the same state: what lasts is in the declared records and on the wire, nowhere else."""
        other = Rig(self.database)
        fill(other.gateway.s, numbers(self.gateway.s))
        for name, station in self.circuits.items():
            fill(other.circuits[name].s, numbers(station.s))
        other._sent = list(self._sent)
        return other

    def run(self, ticks: int) -> None:
        """Some cycles."""
        for _ in range(ticks):
            self.tick()

    def enable(self, ticks: int = 100) -> bool:
        """Enable both drives; whether they were within this time."""
        if self.gateway.enable(DRIVES):
            return False
        self.run(ticks)
        return all(
            self.gateway.devices[name].feedback.state == OPERATION_ENABLED for name in DRIVES
        )

    def inverter(self, name: str) -> Inverter:
        """The state of the inverter itself."""
        return self.circuits[name[-2:]].s.drive


class Fault(NamedTuple):
    """What is put in, the name that it must get, and the cycles within which the torque must be gone."""

    put_in: Callable[[Rig, str, random.Random], None]
    named: str
    limit: int = TIMEOUT + CYCLE


def on_set_points(
    change: Callable[[Frame, random.Random], Frame | None],
) -> Callable[[Rig, str, random.Random], None]:
    """A fault that does something to every set-point of the drive."""

    def put_in(rig: Rig, name: str, chance: random.Random) -> None:
        identifier = rig.database[f"{name}_SetPoint"].identifier
        rig.on_wire = lambda frame: (
            change(frame, chance) if frame.identifier == identifier else frame
        )

    return put_in


def one_bit_wrong(frame: Frame, chance: random.Random) -> Frame:
    """Any bit of the 64."""
    wrong = int.from_bytes(frame.data, "little") ^ (1 << chance.randrange(8 * len(frame.data)))
    return Frame(frame.identifier, wrong.to_bytes(len(frame.data), "little"))


def injected(entry: str, value: float = 1.0) -> Callable[[Rig, str, random.Random], None]:
    """A fault inside the inverter."""
    return lambda rig, name, chance: setattr(rig.inverter(name).injected, entry, value)


def frozen(rig: Rig, name: str, chance: random.Random) -> None:
    """The set-point of now comes again and again, as from a controller that hangs."""
    identifier, kept = rig.database[f"{name}_SetPoint"].identifier, {}
    rig.on_wire = lambda f: kept.setdefault(f.identifier, f) if f.identifier == identifier else f


def silence(rig: Rig, name: str, chance: random.Random) -> None:
    """Nobody tells the gateway what to do any more."""
    rig.silent = True


FAULTS = {
    "lost frames": Fault(on_set_points(lambda frame, chance: None), "CommandTimeout"),
    "wrong counter": Fault(frozen, "WrongCounter"),
    "wrong CRC": Fault(on_set_points(one_bit_wrong), "WrongCrc"),
    "stale feedback: silent": Fault(injected("silent"), "StaleFeedback"),
    "stale feedback: wrong CRC": Fault(injected("wrong_crc"), "StaleFeedback"),
    "stale feedback: wrong counter": Fault(injected("frozen_counter"), "StaleFeedback"),
    "over-temperature, winding": Fault(injected("winding_rise", 120.0), "WindingTemperature"),
    "over-temperature, inverter": Fault(injected("inverter_rise", 80.0), "InverterTemperature"),
    "inverter trip": Fault(injected("trip"), "Trip"),
    "DC-link loss": Fault(injected("supply_lost"), "DcLinkLoss"),
    "DC-link over-voltage": Fault(injected("voltage_rise", 200.0), "DcOverVoltage"),
    "over-current": Fault(injected("current_rise", 700.0), "OverCurrent"),
    "silent controller": Fault(silence, "StaleCommand", limit=100 + CYCLE),
}


def enabled_rig() -> Rig:
    """Both drives enabled without torque."""
    rig = Rig(load_database())
    rig.run(5)
    assert rig.enable()
    return rig


def trial(ready: Rig, fault: Fault, seed: int) -> tuple[int, str]:
    """Cycles until the torque was zero, and what went wrong; empty if nothing did."""
    rig, chance = ready.twin(), random.Random(seed)
    name = chance.choice(DRIVES)
    other = DRIVES[1 - DRIVES.index(name)]
    rig.torque = {drive: chance.choice((-1, 1)) * chance.uniform(10.0, 200.0) for drive in DRIVES}
    rig.run(chance.randrange(20, 60))
    fault.put_in(rig, name, chance)
    cycles = 0
    while rig.inverter(name).torque != 0.0:
        cycles += 1
        if cycles > 1000:
            return cycles, "the torque stays"
        rig.tick()
    if cycles > fault.limit:
        return cycles, f"zero torque after {cycles} ms"
    if fault.named != "StaleCommand" and abs(rig.inverter(other).torque) < 5.0:
        return cycles, "the other drive lost its torque"
    rig.run(25)  # a frame with faults, and a heartbeat, in either direction
    return cycles, named_and_latched(rig, fault, name, ready)


def named_and_latched(rig: Rig, fault: Fault, name: str, ready: Rig) -> str:
    """What went wrong from the fault to the reset."""
    device = rig.gateway.devices[name]
    if fault.named not in diagnosis(device, 0.01).message:
        return f"the diagnosis says {diagnosis(device, 0.01).message}"
    on_bus = (
        rig.heartbeat["CommandStale"]
        if fault.named == "StaleCommand"
        else rig.heartbeat[f"Stale{name}"]
    )
    if fault.named.startswith("Stale") and on_bus != 1.0:
        return "the heartbeat does not name it"
    rig.on_wire, rig.silent = ready.on_wire, False
    rig.inverter(name).injected = Injected()
    rig.run(50)
    if (
        rig.enable(20)
        or rig.inverter(name).torque != 0.0
        or not diagnosis(device, 0.01).message.count(fault.named)
    ):
        return "it did not stay latched"
    rig.gateway.reset()
    rig.run(40)
    if not rig.enable():
        return "it could not be enabled after the reset"
    rig.run(20)
    return "" if abs(rig.inverter(name).torque) > 5.0 else "there is no torque after the reset"


def fuzz(frames: int, seed: int = 1) -> str:
    """What moved, or an empty text; the gateway commands no torque, and nothing is enabled."""
    rig, chance = Rig(load_database()), random.Random(seed)
    known = [layout.identifier for layout in rig.database]
    for count in range(2 * frames):
        identifier = chance.getrandbits(11) if count % 2 else chance.choice(known)
        frame = Frame(identifier, chance.randbytes(chance.randrange(9)))
        circuit = chance.choice(("11", "12"))
        rig.circuits[circuit].receive(frame)
        rig.gateway.receive(circuit, frame)
        if count % 5 == 4:
            rig.silent = True
            rig.tick()
        for station in rig.circuits.values():
            if station.s.speed or station.s.drive.torque or station.s.load.torque:
                return f"a motor moved at frame {count}"
    return ""


def main() -> None:
    """Print the table and, if asked for, write it as JSON; exit status 1 if any trial failed."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--seeds", type=int, default=100)
    parser.add_argument(
        "--fuzz", type=int, default=0, metavar="N", help="send 2 N random frames instead"
    )
    parser.add_argument("--json", type=Path, help="write the result to this file")
    given = parser.parse_args()
    if given.fuzz:
        found = fuzz(given.fuzz)
        print(found or f"{2 * given.fuzz} frames: nothing moved, both ends still run")
        raise SystemExit(bool(found))
    ready, table = enabled_rig(), {}
    print(f"{'fault':32} {'passed':>12} {'zero torque after':>20} {'limit':>8}")
    for what, fault in FAULTS.items():
        tried = [trial(ready, fault, seed) for seed in range(given.seeds)]
        passed, cycles = sum(not wrong for _, wrong in tried), [count for count, _ in tried]
        print(
            f"{what:32} {passed:5d} of {given.seeds:3d} {min(cycles):8d} to {max(cycles):3d} ms"
            f" {fault.limit:5d} ms"
        )
        wrong = sorted({text for _, text in tried if text})
        table[what] = {"passed": passed, "trials": given.seeds, "least_ms": min(cycles), "most_ms": max(cycles),
                       "limit_ms": fault.limit, "wrong": wrong}  # fmt: skip
        for text in wrong:
            print(f"    {text}")
    if given.json:
        given.json.write_text(json.dumps(table, indent=2) + "\n")
    raise SystemExit(any(row["passed"] < row["trials"] for row in table.values()))


if __name__ == "__main__":
    main()
