"""Frames of the bench: faults, cycles, and all layouts in one record.

A payload of 64 bits is a Python int or, compiled, an int64 with the same bits.
"""

from dataclasses import dataclass
from math import pi
from typing import Any, NamedTuple

from ev_msgs_py.can.database import Database, FrameLayout
from ev_msgs_py.can.payload import BitField, extracted, inserted, protected
from ev_msgs_py.compilable import compilable
from ev_msgs_py.refusal import ParameterError

WARNINGS = ("Derating", "FrameRefused", "FramesLost", "Warm", "DcLinkLow")
RPM = pi / 30.0  # rad/s
LONG_AGO = 1e9  # s; an age of what has never been
TICK = 0.001  # s
SENT = ("Motion", "Electrical", "Temperatures", "Faults")  # by each device
# Ticks between frames; after more than 5 without one, profile 1 starts again
# (`checking.TOLERANCES`).
_SELDOM = 6
NO_MODE, TORQUE_MODE, SPEED_MODE = range(3)  # of a set-point
DRIVES, LOADS = ("Drive11", "Drive12"), ("Load11", "Load12")
DEVICES = (*DRIVES, *LOADS)


class Fault(NamedTuple):
    """Fault that a drive latches; its code is that of CiA 402, else from FF01h on."""

    name: str
    code: int
    about: str


FAULTS = (
    Fault("CommandTimeout", 0x8130, "no valid set-point within the time-out"),
    Fault("WrongCrc", 0xFF01, "no valid set-point within the time-out, but some with a wrong CRC"),
    Fault(
        "WrongCounter",
        0xFF02,
        "no valid set-point within the time-out, but some with a repeated or wrong counter",
    ),
    Fault("WindingTemperature", 0x4310, "excess temperature of the winding"),
    Fault("InverterTemperature", 0x4210, "excess temperature of the inverter"),
    Fault("Trip", 0x5400, "the power stage tripped"),
    Fault("DcLinkLoss", 0x3220, "the supply of the DC link is lost"),
    Fault("DcOverVoltage", 0x3210, "over-voltage of the DC link"),
    Fault("PrechargeTimeout", 0xFF03, "the DC link did not charge in time"),
    Fault("OverSpeed", 0x8400, "speed beyond the limit of the machine"),
    Fault("OverCurrent", 0x2310, "continuous over-current"),
    Fault(
        "DirectionChanged", 0xFF04, "another direction was asked for while operation was enabled"
    ),
    Fault("ModeRefused", 0xFF05, "a mode that this inverter does not offer"),
)
(
    COMMAND_TIMEOUT,
    WRONG_CRC_FAULT,
    WRONG_COUNTER,
    WINDING_TEMPERATURE,
    INVERTER_TEMPERATURE,
    TRIP,
    DC_LINK_LOSS,
    DC_OVER_VOLTAGE,
    PRECHARGE_TIMEOUT,
    OVER_SPEED,
    OVER_CURRENT,
    DIRECTION_CHANGED,
    MODE_REFUSED,
) = (1 << place for place in range(len(FAULTS)))  # bits of the latch

DERATING, FRAME_REFUSED, FRAMES_LOST, WARM, DC_LINK_LOW = (
    1 << place for place in range(len(WARNINGS))
)


def names_of(latch: int) -> tuple[str, ...]:
    """The names of the faults in a latch."""
    return tuple(fault.name for place, fault in enumerate(FAULTS) if latch >> place & 1)


@compilable
def is_due(every: float, before: float, now: float) -> bool:
    """Return true if a cycle of so many ticks ends after tick `before` and not after `now`."""
    cycle = int(every)
    return cycle > 0 and int(now) // cycle > int(before) // cycle


def ticks_of(period: float, most: int) -> float:
    """Number of ticks of a control period [s]; ParameterError unless it is 1 to `most` of them."""
    ticks = round(period / TICK)
    if not 1 <= ticks <= most or abs(period - ticks * TICK) > 1e-9:
        raise ParameterError(
            f"control_period: {period!r} is refused, expected on a CAN bus are 1 to {most} cycles "
            f"of {TICK:g} s"
        )
    return float(ticks)


@dataclass(frozen=True, slots=True)
class Kind:
    """Layout that all frames of one kind have in common."""

    length: float  # bytes
    ticks: float  # of 1 ms between two of them


@dataclass(frozen=True, slots=True)
class SetPointLayout(Kind):
    """Frame with the command of a device."""

    mode: BitField
    direction: BitField
    controlword: BitField
    torque: BitField
    speed: BitField
    torque_limit: BitField


@dataclass(frozen=True, slots=True)
class MotionLayout(Kind):
    """Frame with the motion of a device."""

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
    """Frame with the temperatures of a device."""

    winding: BitField
    inverter: BitField
    coolant_in: BitField
    coolant_out: BitField
    rotor: BitField
    coolant_flow: BitField


@dataclass(frozen=True, slots=True)
class FaultsLayout(Kind):
    """Latched faults and present warnings, each group of bits one number."""

    error_code: BitField
    faults: BitField
    warnings: BitField


@dataclass(frozen=True, slots=True)
class HeartbeatLayout(Kind):
    """Latched faults and enabled devices of the controller, each group of bits one number."""

    command_stale: BitField
    implausible: BitField
    stale: BitField
    enable: BitField


@dataclass(frozen=True, slots=True)
class DeviceFrames:
    """Identifiers and E2E data ids of a device: of its set-point, and of what it sends (SENT)."""

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
    """The frames in a database.

    ParameterError if one is missing, if devices have different ones, if a set-point cannot take the
    torque away, or if motion comes so seldom that its receiver takes none.
    """
    heartbeat = database["Ecu_Heartbeat"]
    return BenchFrames(
        set_point=_set_point(database),
        motion=_motion(database),
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


def _set_point(database: Database) -> SetPointLayout:
    """Refuse a frame with signals that cannot be zero, as limits, reverse and reset need it."""
    layout: SetPointLayout = _common(database, "SetPoint", SetPointLayout)
    for name, field in database[f"{DEVICES[0]}_SetPoint"].signals.items():
        if extracted(inserted(0, field, 0.0), field) != 0.0:
            raise ParameterError(
                f"frame {DEVICES[0]}_SetPoint, signal {name}: scale {field.scale:g}, offset "
                f"{field.offset:g} and range "
                f"{field.low:g} to {field.high:g} are refused, expected a signal that can be 0"
            )
    return layout


def _motion(database: Database) -> MotionLayout:
    layout: MotionLayout = _common(database, "Motion", MotionLayout)
    if layout.ticks > _SELDOM:
        raise ParameterError(
            f"frame {DEVICES[0]}_Motion: a cycle of {layout.ticks:g} ms is refused, expected "
            f"{_SELDOM} ms or less"
        )
    return layout


def _common(database: Database, kind: str, of: type) -> Any:
    first = database[f"{DEVICES[0]}_{kind}"]
    for device in DEVICES:
        other = database[f"{device}_{kind}"]
        if (other.length, other.cycle, other.signals) != (first.length, first.cycle, first.signals):
            raise ParameterError(
                f"frame {other.name} differs from {first.name}; expected one layout for all devices"
            )
    return _layout(first, of)


def _layout(frame: FrameLayout, of: Any) -> Any:
    names = [name for name in of.__dataclass_fields__ if name not in ("length", "ticks")]
    return of(
        float(frame.length),
        float(round(frame.cycle / TICK)),
        *(_field(frame, name) for name in names),
    )


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
            raise ParameterError(
                f"frame {frame.name}: {', '.join(signals)} must be single bits in a row"
            )
    return BitField(
        fields[0].start, float(len(fields)), 0.0, 1.0, 1.0, 0.0, 0.0, float((1 << len(fields)) - 1)
    )


def _device(database: Database, device: str) -> DeviceFrames:
    set_point = database[f"{device}_SetPoint"]
    sent = [database[f"{device}_{kind}"] for kind in SENT]
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
