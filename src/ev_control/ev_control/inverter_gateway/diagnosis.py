"""What is to be said of an inverter: how bad it is, in words, and in numbers."""

from __future__ import annotations

from typing import NamedTuple

from ev_control.inverter_gateway.leading import is_faulty
from ev_control.inverter_gateway.state import Device
from ev_msgs_py.can.drive_states import FAULT, FAULT_REACTION_ACTIVE, STATE_NAMES
from ev_msgs_py.can.frames import FAULTS, WARNINGS, names_of
from ev_msgs_py.compilable import compilable

GOOD, WARNED, FAULTY, SILENT = range(4)  # as the levels of diagnostic_msgs: OK, WARN, ERROR, STALE
OWN_FAULTS = ("StaleFeedback", "StaleCommand", "Implausible")  # of the gateway, in the bits above those of FAULTS


class Diagnosis(NamedTuple):
    """Level, one line, and details by name."""

    level: int
    message: str
    details: dict[str, str]


def diagnosis(s: Device, feedback_timeout: float) -> Diagnosis:
    """The diagnosis of a device; a latched fault comes before everything else."""
    feedback = s.feedback
    state, faults = int(feedback.state), latched_names(latched(s))
    warned = [name for place, name in enumerate(WARNINGS) if int(feedback.warning_bits) >> place & 1]
    details = {
        "state": STATE_NAMES[state],
        "faults": ", ".join(faults),
        "warnings": ", ".join(warned),
        "error_code": f"{int(feedback.error_code):04X}h",
        "feedback_age_s": f"{feedback.age:.4f}" if feedback.age < 1e6 else "never heard",
        "frames_refused": f"{feedback.refused:.0f}",
        "frames_lost": f"{feedback.lost:.0f}",
        "dc_voltage_V": f"{feedback.dc_voltage:.3f}",
        "winding_temperature_degC": f"{feedback.winding_temperature:.1f}",
    }
    if faults or is_faulty(s) or state in (FAULT, FAULT_REACTION_ACTIVE):
        return Diagnosis(FAULTY, f"{STATE_NAMES[state]}: {', '.join(faults) or 'fault not yet named'}", details)
    if feedback.age > feedback_timeout:
        return Diagnosis(SILENT, "no valid feedback", details)
    if warned:
        return Diagnosis(WARNED, f"{STATE_NAMES[state]}: {', '.join(warned)}", details)
    return Diagnosis(GOOD, STATE_NAMES[state], details)


@compilable
def latched(s: Device) -> int:
    """The bits of all faults that are latched, in the inverter and in the gateway."""
    own = int(s.stale) + 2 * int(s.command_stale) + 4 * int(s.implausible)
    return int(s.feedback.fault_bits) | own << len(FAULTS)


def latched_names(bits: int) -> tuple[str, ...]:
    """The names of faults in the bits of `latched`."""
    return (*names_of(bits), *(name for place, name in enumerate(OWN_FAULTS) if bits >> (len(FAULTS) + place) & 1))
