"""One cycle of an inverter: what is wrong, which state follows, which torque."""

from __future__ import annotations

from ev_core.law import compilable
from ev_msgs_py.can import drive_states, frames
from ev_sim.inverter import power_stage
from ev_sim.inverter.device import Inverter
from ev_sim.inverter.inverter_parameters import InverterParameters
from ev_sim.inverter.on_channel import begin_cycle, end_cycle, missing_set_point

_NO_TORQUE = 1.0  # N m, the error of the torque transducer: below it a quick stop is over
_CODES = tuple(float(fault.code) for fault in frames.FAULTS)


@compilable
def advance_inverter(p: InverterParameters, s: Inverter, speed: float, period: float) -> None:
    """Advance over `period` [s] at a shaft speed [rad/s], after the frames of this cycle were received.

    A fault takes the torque away in the cycle in which it is found.
    """
    lead_inverter(p, s, speed, period)
    power_stage.advance_torque(p, s, speed, period)
    power_stage.advance_temperatures(p.thermal, p.machine, s, period)
    end_inverter_cycle(p, s, period)


@compilable
def lead_inverter(p: InverterParameters, s: Inverter, speed: float, period: float) -> None:
    """The first part of a cycle: what is wrong, and which state follows."""
    begin_cycle(s)
    power_stage.advance_dc_link(p.dc_link, s, period)
    causes = _causes(p, s, speed, period)
    _latch(s, causes)
    control, torque_gone = int(s.command.controlword), abs(s.torque) < _NO_TORQUE
    silent = missing_set_point(s, p.command_timeout, period) != 0
    before, charged = int(s.state), s.dc_link.contactor != 0.0
    reset, faulty = s.command.reset != 0.0 and not silent, causes != 0
    s.state = float(drive_states.next_state(before, control, reset, faulty, charged, torque_gone))
    if s.state == drive_states.SWITCH_ON_DISABLED and not faulty:
        s.faults = s.error_code = 0.0
    if s.state != drive_states.OPERATION_ENABLED:
        s.direction = s.command.direction


@compilable
def end_inverter_cycle(p: InverterParameters, s: Inverter, period: float) -> None:
    """The last part of a cycle, behind torque and temperatures: warnings, and everything gets older."""
    s.warnings = float(_warnings(p, s))
    end_cycle(s, period)


@compilable
def _causes(p: InverterParameters, s: Inverter, speed: float, period: float) -> int:
    """The bits of everything that is wrong now."""
    state, mode = int(s.state), int(s.command.mode)
    bits = power_stage.temperature_faults(p.thermal, s) | power_stage.dc_link_faults(p.dc_link, s)
    if s.injected.trip != 0.0:
        bits |= frames.TRIP
    if abs(speed) > p.over_speed * p.machine.maximum_speed:
        bits |= frames.OVER_SPEED
    if s.phase_current + s.injected.current_rise > p.largest_current:
        bits |= frames.OVER_CURRENT
    if drive_states.READY_TO_SWITCH_ON <= state <= drive_states.QUICK_STOP_ACTIVE:
        bits |= missing_set_point(s, p.command_timeout, period)
        offered = mode in (frames.NO_MODE, frames.TORQUE_MODE) or (
            mode == frames.SPEED_MODE and p.offers_speed_mode != 0.0
        )
        if not offered:
            bits |= frames.MODE_REFUSED
    if state == drive_states.OPERATION_ENABLED and s.command.direction != s.direction:
        bits |= frames.DIRECTION_CHANGED
    return bits


@compilable
def _latch(s: Inverter, causes: int) -> None:
    if causes != 0 and s.faults == 0.0:
        place = 0
        while (causes >> place) & 1 == 0:
            place += 1
        s.error_code = _CODES[place]
    s.faults = float(int(s.faults) | causes)


@compilable
def _warnings(p: InverterParameters, s: Inverter) -> int:
    bits = 0
    if power_stage.derating(p.thermal, s) < 1.0:
        bits |= frames.DERATING | frames.WARM
    if s.supervision.refused_age <= p.command_timeout:
        bits |= frames.FRAME_REFUSED
    if s.supervision.lost_age <= p.command_timeout:
        bits |= frames.FRAMES_LOST
    if s.dc_link.contactor != 0.0 and s.dc_link.voltage < 0.9 * p.dc_link.supply_voltage:
        bits |= frames.DC_LINK_LOW
    return bits
