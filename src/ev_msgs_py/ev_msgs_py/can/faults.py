"""The faults and warnings of a drive: their names on the bus and what they mean, in the order of their bits."""

from __future__ import annotations

from typing import NamedTuple


class Fault(NamedTuple):
    """A fault that a drive latches; `code` is that of CiA 402 where it has one, else from FF01h on."""

    name: str
    code: int
    about: str


FAULTS = (
    Fault("CommandTimeout", 0x8130, "no valid set-point within the time-out"),
    Fault("WrongCrc", 0xFF01, "no valid set-point within the time-out, but some with a wrong CRC"),
    Fault("WrongCounter", 0xFF02, "no valid set-point within the time-out, but some with a repeated or wrong counter"),
    Fault("WindingTemperature", 0x4310, "excess temperature of the winding"),
    Fault("InverterTemperature", 0x4210, "excess temperature of the inverter"),
    Fault("Trip", 0x5400, "the power stage tripped"),
    Fault("DcLinkLoss", 0x3220, "the supply of the DC link is lost"),
    Fault("DcOverVoltage", 0x3210, "over-voltage of the DC link"),
    Fault("PrechargeTimeout", 0xFF03, "the DC link did not charge in time"),
    Fault("OverSpeed", 0x8400, "speed beyond the limit of the machine"),
    Fault("OverCurrent", 0x2310, "continuous over-current"),
    Fault("DirectionChanged", 0xFF04, "another direction was asked for while operation was enabled"),
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

WARNINGS = ("Derating", "FrameRefused", "FramesLost", "Warm", "DcLinkLow")
DERATING, FRAME_REFUSED, FRAMES_LOST, WARM, DC_LINK_LOW = (1 << place for place in range(len(WARNINGS)))


def names_of(latch: int) -> tuple[str, ...]:
    """The names of the faults in a latch."""
    return tuple(fault.name for place, fault in enumerate(FAULTS) if latch >> place & 1)
