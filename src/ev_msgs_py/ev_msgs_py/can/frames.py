"""The frames of the bench as the ends of the bus know them: all layouts in one record that compiled code reads too.

A payload of 64 bits is a Python int or, compiled, an int64 with the same bits.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ev_msgs_py.can.codec import BitField
from ev_msgs_py.can.database import Database
from ev_msgs_py.can.faults import FAULTS, WARNINGS
from ev_msgs_py.can.frame_layout import FrameLayout
from ev_msgs_py.can.protection import protected
from ev_msgs_py.can.schedule import TICK
from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.parameters.declaration import ParameterError

DRIVES, LOADS = ("Drive11", "Drive12"), ("Load11", "Load12")
DEVICES = (*DRIVES, *LOADS)
SENT = ("Motion", "Electrical", "Temperatures", "Faults")  # by each device


@dataclass(frozen=True, slots=True)
class Kind:
    """What all frames of one kind have in common."""

    length: float  # bytes
    ticks: float  # of 1 ms between two of them


@dataclass(frozen=True, slots=True)
class SetPointLayout(Kind):
    """What a device shall do."""

    mode: BitField
    direction: BitField
    controlword: BitField
    torque: BitField
    speed: BitField
    torque_limit: BitField


@dataclass(frozen=True, slots=True)
class MotionLayout(Kind):
    """What a device does."""

    command_check: BitField
    torque: BitField
    speed: BitField
    statusword: BitField


@dataclass(frozen=True, slots=True)
class ElectricalLayout(Kind):
    """Voltages and currents."""

    dc_voltage: BitField
    dc_current: BitField
    phase_current: BitField
    phase_voltage: BitField


@dataclass(frozen=True, slots=True)
class TemperaturesLayout(Kind):
    """What is warm."""

    winding: BitField
    inverter: BitField
    coolant_in: BitField
    coolant_out: BitField
    rotor: BitField
    coolant_flow: BitField


@dataclass(frozen=True, slots=True)
class FaultsLayout(Kind):
    """Latched faults and present warnings; each group of bits is one number here, by place in FAULTS and WARNINGS."""

    error_code: BitField
    faults: BitField
    warnings: BitField


@dataclass(frozen=True, slots=True)
class HeartbeatLayout(Kind):
    """What the controller has latched and enabled, by device; bits of one group are one number here, too."""

    command_stale: BitField
    implausible: BitField
    stale: BitField
    enable: BitField


@dataclass(frozen=True, slots=True)
class DeviceFrames:
    """Identifiers and E2E data ids of one device: of its set-point, then of what it sends, in the order of SENT."""

    set_point: float
    set_point_data_id: float
    identifiers: list[float]
    data_ids: list[float]


@dataclass(frozen=True, slots=True)
class BenchFrames:
    """All frames."""

    set_point: SetPointLayout
    motion: MotionLayout
    electrical: ElectricalLayout
    temperatures: TemperaturesLayout
    faults: FaultsLayout
    heartbeat: HeartbeatLayout
    drive_11: DeviceFrames
    drive_12: DeviceFrames
    load_11: DeviceFrames
    load_12: DeviceFrames
    ecu: float  # identifier of the heartbeat
    ecu_data_id: float


def bench_frames(database: Database) -> BenchFrames:
    """The frames in a database; ParameterError if one is missing, or if devices have different ones."""
    heartbeat = database["Ecu_Heartbeat"]
    return BenchFrames(
        set_point=_common(database, "SetPoint", SetPointLayout),
        motion=_common(database, "Motion", MotionLayout),
        electrical=_common(database, "Electrical", ElectricalLayout),
        temperatures=_common(database, "Temperatures", TemperaturesLayout),
        faults=_common(database, "Faults", FaultsLayout),
        heartbeat=_layout(heartbeat, HeartbeatLayout),
        drive_11=_device(database, "Drive11"),
        drive_12=_device(database, "Drive12"),
        load_11=_device(database, "Load11"),
        load_12=_device(database, "Load12"),
        ecu=float(heartbeat.identifier),
        ecu_data_id=float(heartbeat.data_id),
    )


_GROUPS = {
    "faults": tuple(fault.name for fault in FAULTS),
    "warnings": WARNINGS,
    "implausible": tuple(f"Implausible{device}" for device in DRIVES),
    "stale": tuple(f"Stale{device}" for device in DEVICES),
    "enable": tuple(f"Enable{device}" for device in DEVICES),
}


def _common(database: Database, kind: str, of: type) -> Any:
    first = database[f"{DEVICES[0]}_{kind}"]
    for device in DEVICES:
        other = database[f"{device}_{kind}"]
        if (other.length, other.cycle, other.signals) != (first.length, first.cycle, first.signals):
            raise ParameterError(f"frame {other.name} differs from {first.name}; allowed is one layout for all devices")
    return _layout(first, of)


def _layout(frame: FrameLayout, of: Any) -> Any:
    names = [name for name in of.__dataclass_fields__ if name not in ("length", "ticks")]
    return of(float(frame.length), float(round(frame.cycle / TICK)), *(_field(frame, name) for name in names))


def _field(frame: FrameLayout, name: str) -> BitField:
    """The signal of this name, or the group of single bits in a row."""
    signals = _GROUPS.get(name, ("".join(word.capitalize() for word in name.split("_")),))
    missing = [signal for signal in signals if signal not in frame.signals]
    if missing:
        raise ParameterError(f"frame {frame.name}: the signal {missing[0]} is missing")
    fields = [frame.signals[signal] for signal in signals]
    if len(fields) == 1:
        return fields[0]
    for place, field in enumerate(fields):
        if field.length != 1.0 or field.start != fields[0].start + place:
            raise ParameterError(f"frame {frame.name}: {', '.join(signals)} must be single bits in a row")
    return BitField(fields[0].start, float(len(fields)), 0.0, 1.0, 1.0, 0.0, 0.0, float((1 << len(fields)) - 1))


def _device(database: Database, device: str) -> DeviceFrames:
    set_point, sent = database[f"{device}_SetPoint"], [database[f"{device}_{kind}"] for kind in SENT]
    return DeviceFrames(
        float(set_point.identifier),
        float(set_point.data_id),
        [float(frame.identifier) for frame in sent],
        [float(frame.data_id) for frame in sent],
    )


@compilable
def guarded(layout: Any, payload: int, data_id: float, counter: int) -> int:
    """The payload of a frame of this kind, with counter and checksum."""
    return protected(payload, int(layout.length), int(data_id), counter)
