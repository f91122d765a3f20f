"""What an inverter says: the payloads of its frames."""

from __future__ import annotations

from ev_core.law import compilable, sqrt
from ev_msgs_py.can.frames import RPM, SENT, BenchFrames, DeviceFrames, guarded
from ev_msgs_py.can.payload import inserted, last_counter, next_counter
from ev_sim.inverter.inverter import statusword
from ev_sim.inverter.parameters import InverterParameters
from ev_sim.inverter.state import Inverter
from ev_sim.inverter.torque import coolant_outlet, inverter_temperature, winding_temperature

MOTION, ELECTRICAL, TEMPERATURES, FAULTS = range(len(SENT))
_WRONG = 0xFF  # what a corrupted checksum is changed by


@compilable
def ticks_between(f: BenchFrames, kind: int) -> float:
    """Cycles of 1 ms between two frames of a kind."""
    if kind == MOTION:
        return f.motion.ticks
    if kind == ELECTRICAL:
        return f.electrical.ticks
    return f.temperatures.ticks if kind == TEMPERATURES else f.faults.ticks


@compilable
def made(f: BenchFrames, own: DeviceFrames, p: InverterParameters, s: Inverter, kind: int, speed: float) -> int:
    """The payload of the next frame of a kind at a shaft speed [rad/s]; its counter goes on."""
    frozen = s.injected.frozen_counter != 0.0
    counter = int(s.counters[kind])
    used = last_counter(counter) if frozen else counter
    if not frozen:
        s.counters[kind] = float(next_counter(counter))
    data_id = own.data_ids[kind]
    if kind == MOTION:
        payload = guarded(f.motion, _motion(f, s, speed), data_id, used)
    elif kind == ELECTRICAL:
        payload = guarded(f.electrical, _electrical(f, s), data_id, used)
    elif kind == TEMPERATURES:
        payload = guarded(f.temperatures, _temperatures(f, p, s), data_id, used)
    else:
        payload = guarded(f.faults, _faults(f, s), data_id, used)
    return payload ^ _WRONG if s.injected.wrong_crc != 0.0 else payload


@compilable
def _motion(f: BenchFrames, s: Inverter, speed: float) -> int:
    payload = inserted(0, f.motion.command_check, s.check.status)
    payload = inserted(payload, f.motion.torque, s.torque)
    payload = inserted(payload, f.motion.speed, speed / RPM)
    return inserted(payload, f.motion.statusword, float(statusword(s)))


@compilable
def _electrical(f: BenchFrames, s: Inverter) -> int:
    payload = inserted(0, f.electrical.dc_voltage, s.dc_link.voltage + s.injected.voltage_rise)
    payload = inserted(payload, f.electrical.dc_current, s.dc_current)
    payload = inserted(payload, f.electrical.phase_current, s.phase_current + s.injected.current_rise)
    return inserted(payload, f.electrical.phase_voltage, sqrt(3.0) * s.phase_voltage)


@compilable
def _temperatures(f: BenchFrames, p: InverterParameters, s: Inverter) -> int:
    """The rotor is not modelled by itself: it says what the winding does."""
    winding = winding_temperature(p.thermal, s)
    payload = inserted(0, f.temperatures.winding, winding)
    payload = inserted(payload, f.temperatures.inverter, inverter_temperature(p.thermal, s))
    payload = inserted(payload, f.temperatures.coolant_in, p.thermal.coolant)
    payload = inserted(payload, f.temperatures.coolant_out, coolant_outlet(p.thermal, s))
    payload = inserted(payload, f.temperatures.rotor, winding)
    return inserted(payload, f.temperatures.coolant_flow, p.thermal.coolant_flow)


@compilable
def _faults(f: BenchFrames, s: Inverter) -> int:
    payload = inserted(0, f.faults.error_code, s.error_code)
    payload = inserted(payload, f.faults.faults, s.faults)
    return inserted(payload, f.faults.warnings, s.warnings)
