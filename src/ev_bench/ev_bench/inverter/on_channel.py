"""An inverter on its CAN channel: it judges set-points and builds the payloads of its frames."""

from __future__ import annotations

from ev_bench.bus import checking
from ev_bench.inverter.device import Inverter, InverterParameters
from ev_bench.inverter.power_stage import coolant_outlet, inverter_temperature, winding_temperature
from ev_core.law import compilable, sqrt
from ev_msgs_py.can import drive_states, frames
from ev_msgs_py.can.payload import extracted, inserted, last_counter, next_counter

MOTION, ELECTRICAL, TEMPERATURES, FAULTS = range(len(frames.SENT))
_WRONG = 0xFF  # what a corrupted checksum is changed by


@compilable
def receive_set_point(
    layout: frames.SetPointLayout, own: frames.DeviceFrames, s: Inverter, payload: int
) -> int:
    """Judge a set-point frame, take its content if it is valid, and return the status."""
    s.supervision.heard = 1.0
    status = checking.check(
        checking.TOLERANCES, s.check, payload, int(layout.length), int(own.set_point_data_id)
    )
    if checking.is_valid(status):
        _take_over(layout, s, payload)
        s.supervision.age = s.supervision.wrong_crc = s.supervision.wrong_counter = 0.0
        # The content is used, and the warning of lost frames begins again.
        if status == checking.OK_SOME_LOST:
            s.supervision.lost_age = 0.0
        return status
    if status == checking.WRONG_CRC:
        s.supervision.wrong_crc += 1.0
        s.supervision.refused_age = 0.0
    elif status in (checking.REPEATED, checking.WRONG_SEQUENCE):
        s.supervision.wrong_counter += 1.0
        s.supervision.refused_age = 0.0
    return status


@compilable
def _take_over(layout: frames.SetPointLayout, s: Inverter, payload: int) -> None:
    """Take a reset: its bit rises, without a torque set-point and with operation disabled."""
    before = int(s.command.controlword)
    control = int(extracted(payload, layout.controlword))
    torque = extracted(payload, layout.torque)
    # CiA 402 resets by the edge: a bit that stays set is no second reset.
    risen = control & drive_states.FAULT_RESET != 0 and before & drive_states.FAULT_RESET == 0
    if risen and torque == 0.0 and control & drive_states.ENABLE_OPERATION == 0:
        s.command.reset = 1.0
    s.command.controlword = float(control)
    s.command.mode = extracted(payload, layout.mode)
    s.command.direction = extracted(payload, layout.direction)
    s.command.torque = torque
    s.command.speed = frames.RPM * extracted(payload, layout.speed)
    s.command.torque_limit = extracted(payload, layout.torque_limit)


@compilable
def grow_older(s: Inverter, duration: float) -> None:
    """Time [s] has passed without a cycle, as in a process that was held up."""
    s.supervision.age += duration
    s.supervision.refused_age += duration
    s.supervision.lost_age += duration


@compilable
def missing_set_point(s: Inverter, timeout: float, period: float) -> int:
    """Fault bit for the lack of a valid set-point in the last `timeout` [s]; 0 if there was one.

    To half a period, so that it does not depend on how the age was rounded.
    """
    if s.supervision.age < timeout - 0.5 * period:
        return 0
    if s.supervision.wrong_crc > 0.0:
        return frames.WRONG_CRC_FAULT
    return frames.WRONG_COUNTER if s.supervision.wrong_counter > 0.0 else frames.COMMAND_TIMEOUT


@compilable
def ticks_between(f: frames.BenchFrames, kind: int) -> float:
    """Cycles of 1 ms between two frames of a kind."""
    if kind == MOTION:
        return f.motion.ticks
    if kind == ELECTRICAL:
        return f.electrical.ticks
    return f.temperatures.ticks if kind == TEMPERATURES else f.faults.ticks


@compilable
def made(
    f: frames.BenchFrames,
    own: frames.DeviceFrames,
    p: InverterParameters,
    s: Inverter,
    kind: int,
    speed: float,
) -> int:
    """The payload of the next frame of a kind at a shaft speed [rad/s]; its counter goes on."""
    frozen = s.injected.frozen_counter != 0.0
    counter = int(s.counters[kind])
    # A frozen counter stays that of the frame before, which a receiver takes for a repetition.
    used = last_counter(counter) if frozen else counter
    if not frozen:
        s.counters[kind] = float(next_counter(counter))
    data_id = own.data_ids[kind]
    if kind == MOTION:
        payload = frames.guarded(f.motion, _motion(f, s, speed), data_id, used)
    elif kind == ELECTRICAL:
        payload = frames.guarded(f.electrical, _electrical(f, s), data_id, used)
    elif kind == TEMPERATURES:
        payload = frames.guarded(f.temperatures, _temperatures(f, p, s), data_id, used)
    else:
        payload = frames.guarded(f.faults, _faults(f, s), data_id, used)
    return payload ^ _WRONG if s.injected.wrong_crc != 0.0 else payload


@compilable
def statusword(s: Inverter) -> int:
    """Bits 0 to 11 of the statusword."""
    word = drive_states.STATE_BITS[int(s.state)] | (drive_states.REMOTE if s.remote != 0.0 else 0)
    if s.dc_link.contactor != 0.0:
        word |= drive_states.VOLTAGE_ENABLED
    if s.warnings != 0.0:
        word |= drive_states.WARNING
    return word | (drive_states.INTERNAL_LIMIT if s.limited != 0.0 else 0)


@compilable
def _motion(f: frames.BenchFrames, s: Inverter, speed: float) -> int:
    payload = inserted(0, f.motion.command_check, s.check.status)
    payload = inserted(payload, f.motion.torque, s.torque)
    payload = inserted(payload, f.motion.speed, speed / frames.RPM)
    return inserted(payload, f.motion.statusword, float(statusword(s)))


@compilable
def _electrical(f: frames.BenchFrames, s: Inverter) -> int:
    payload = inserted(0, f.electrical.dc_voltage, s.dc_link.voltage + s.injected.voltage_rise)
    payload = inserted(payload, f.electrical.dc_current, s.dc_current)
    payload = inserted(
        payload, f.electrical.phase_current, s.phase_current + s.injected.current_rise
    )
    # Between two phases, sqrt(3) times that to the neutral.
    return inserted(payload, f.electrical.phase_voltage, sqrt(3.0) * s.phase_voltage)


@compilable
def _temperatures(f: frames.BenchFrames, p: InverterParameters, s: Inverter) -> int:
    """The rotor is not modelled by itself: its temperature is that of the winding."""
    winding = winding_temperature(p.thermal, s)
    payload = inserted(0, f.temperatures.winding, winding)
    payload = inserted(payload, f.temperatures.inverter, inverter_temperature(p.thermal, s))
    payload = inserted(payload, f.temperatures.coolant_in, p.thermal.coolant)
    payload = inserted(payload, f.temperatures.coolant_out, coolant_outlet(p.thermal, s))
    payload = inserted(payload, f.temperatures.rotor, winding)
    return inserted(payload, f.temperatures.coolant_flow, p.thermal.coolant_flow)


@compilable
def _faults(f: frames.BenchFrames, s: Inverter) -> int:
    payload = inserted(0, f.faults.error_code, s.error_code)
    payload = inserted(payload, f.faults.faults, s.faults)
    return inserted(payload, f.faults.warnings, s.warnings)
