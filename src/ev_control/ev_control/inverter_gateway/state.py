"""What the gateway keeps between two cycles."""

from __future__ import annotations

from dataclasses import dataclass

from ev_core.bus.checking import CheckState
from ev_core.parameters.record import entry, part, series
from ev_msgs_py.can.frames import LONG_AGO


@dataclass(slots=True)
class Feedback:
    """What an inverter has said last, as it arrived."""

    motion: CheckState = part(CheckState)
    electrical: CheckState = part(CheckState)
    temperatures: CheckState = part(CheckState)
    faults: CheckState = part(CheckState)
    heard: float = entry(unit="1", about="whether a frame with its state has come in this cycle, valid or not")
    age: float = entry(LONG_AGO, unit="s", about="of the newest valid frame with its state")
    refused: float = entry(unit="1", about="frames with a wrong CRC or counter")
    lost: float = entry(unit="1", about="frames that were lost, as their counters tell")
    state: float = entry(unit="1", about="place in STATE_NAMES")
    remote: float = entry(1.0, unit="1", about="whether it says that it follows its controlword")
    torque: float = entry(unit="N m", about="at the shaft")
    torque_sum: float = entry(unit="N m", about="of all torques since the last look at what is plausible")
    torque_count: float = entry(unit="1", about="how many there were")
    speed: float = entry(unit="rad/s", about="of the shaft")
    dc_voltage: float = entry(unit="V")
    dc_current: float = entry(unit="A", about="from the supply")
    phase_current: float = entry(unit="A", about="rms")
    winding_temperature: float = entry(unit="degC")
    inverter_temperature: float = entry(unit="degC")
    fault_bits: float = entry(unit="1", about="by place in FAULTS")
    warning_bits: float = entry(unit="1", about="by place in WARNINGS")
    error_code: float = entry(unit="1")


@dataclass(slots=True)
class Device:
    """One inverter as the gateway leads it."""

    feedback: Feedback = part(Feedback)
    enable: float = entry(unit="1", about="whether it shall be enabled")
    tripped: float = entry(unit="1", about="latched: it was in a fault while it was to be enabled")
    stale: float = entry(unit="1", about="latched: its feedback stayed away")
    command_stale: float = entry(unit="1", about="latched: the command for it stayed away")
    implausible: float = entry(unit="1", about="latched: its circuit measures what cannot be, see `plausibility`")
    doubtful_time: float = entry(unit="s", about="since when what is measured cannot be")
    watched_speed: float = entry(unit="rad/s", about="that the transducer showed at the last look")
    command_age: float = entry(LONG_AGO, unit="s")
    reset_time: float = entry(-1.0, unit="s", about="since the reset sequence began; -1: there is none")
    mode: float = entry(unit="1", about="as in the set-point frame")
    torque: float = entry(unit="N m", about="set-point, at the shaft")
    speed: float = entry(unit="rad/s", about="set-point in speed mode, limit in torque mode")
    counter: float = entry(unit="1", about="of the next set-point")


@dataclass(slots=True)
class Gateway:
    """All four inverters."""

    drive_11: Device = part(Device)
    drive_12: Device = part(Device)
    load_11: Device = part(Device)
    load_12: Device = part(Device)
    tick: float = entry(unit="1", about="cycles of 1 ms since the start")
    waits: float = entry(
        unit="1",
        about="for the first moment at which the drives may be enabled by themselves, 1 and the cycles for one alone",
    )
    commanded: float = entry(-1.0, unit="ns", about="stamp of the newest torque command, in real time")
    heartbeat_counters: list[float] = series(2, unit="1", about="of the next heartbeat of each circuit")
