"""What the gateway says: set-points, and what it has latched and enabled."""

from __future__ import annotations

from ev_control.inverter_gateway.leading import controlword, may_turn
from ev_control.inverter_gateway.state import Device, Gateway
from ev_msgs_py.can.frames import RPM, BenchFrames, DeviceFrames, guarded
from ev_msgs_py.can.payload import inserted
from ev_msgs_py.can.protection import next_counter
from ev_msgs_py.compilable import compilable


@compilable
def set_point(f: BenchFrames, own: DeviceFrames, s: Device, most: float) -> int:
    """The payload of the next set-point, with a torque of at most `most` [N m]; its counter goes on."""
    turns = may_turn(s)
    payload = inserted(0, f.set_point.mode, s.mode)
    payload = inserted(payload, f.set_point.controlword, float(controlword(s)))
    payload = inserted(payload, f.set_point.torque, min(max(s.torque, -most), most) if turns else 0.0)
    payload = inserted(payload, f.set_point.speed, s.speed / RPM if turns else 0.0)
    payload = inserted(payload, f.set_point.torque_limit, most if turns else 0.0)
    counter = int(s.counter)
    s.counter = float(next_counter(counter))
    return guarded(f.set_point, payload, own.set_point_data_id, counter)


@compilable
def heartbeat(f: BenchFrames, s: Gateway, place: int) -> int:
    """The payload of the next heartbeat of a circuit; its counter goes on."""
    latched = max(
        max(s.drive_11.command_stale, s.drive_12.command_stale), max(s.load_11.command_stale, s.load_12.command_stale)
    )
    stale = s.drive_11.stale + 2.0 * s.drive_12.stale + 4.0 * s.load_11.stale + 8.0 * s.load_12.stale
    enable = s.drive_11.enable + 2.0 * s.drive_12.enable + 4.0 * s.load_11.enable + 8.0 * s.load_12.enable
    payload = inserted(0, f.heartbeat.command_stale, latched)
    payload = inserted(payload, f.heartbeat.implausible, s.drive_11.implausible + 2.0 * s.drive_12.implausible)
    payload = inserted(payload, f.heartbeat.stale, stale)
    payload = inserted(payload, f.heartbeat.enable, enable)
    counter = int(s.heartbeat_counters[place])
    s.heartbeat_counters[place] = float(next_counter(counter))
    return guarded(f.heartbeat, payload, f.ecu_data_id, counter)
