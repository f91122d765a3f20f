"""Leading an inverter through its states: feedback in, enable, stop at the first fault, reset in sequence, frames out.

Feedback is checked frame by frame, and kept as far as it is valid. Set-points and a heartbeat go out, which has what
the gateway has latched and enabled.
"""

from ev_bench.bus import checking
from ev_bench.inverter_gateway.gateway import BOTH, Device, Feedback, Gateway, GatewayParameters, most_torque
from ev_msgs_py.can import drive_states
from ev_msgs_py.can.frames import RPM, SENT, TORQUE_MODE, BenchFrames, DeviceFrames, guarded
from ev_msgs_py.can.payload import extracted, inserted, next_counter, rounded_down
from ev_msgs_py.compilable import compilable

MOTION, ELECTRICAL, TEMPERATURES, FAULTS = range(len(SENT))


@compilable
def receive_feedback(f: BenchFrames, own: DeviceFrames, s: Feedback, kind: int, payload: int) -> None:
    """Take a frame of this device; what is not valid is counted."""
    data_id = own.data_ids[kind]
    if kind == MOTION:
        s.heard = 1.0
        if _is_good(s, s.motion, payload, f.motion.length, data_id):
            word = int(extracted(payload, f.motion.statusword))
            s.age, s.state, s.remote = (
                0.0,
                float(drive_states.state_of(word)),
                1.0 if word & drive_states.REMOTE != 0 else 0.0,
            )
            s.torque = extracted(payload, f.motion.torque)
            s.torque_sum += s.torque
            s.torque_count += 1.0
            s.speed = RPM * extracted(payload, f.motion.speed)
    elif kind == ELECTRICAL:
        if _is_good(s, s.electrical, payload, f.electrical.length, data_id):
            s.dc_voltage = extracted(payload, f.electrical.dc_voltage)
            s.dc_current = extracted(payload, f.electrical.dc_current)
            s.phase_current = extracted(payload, f.electrical.phase_current)
    elif kind == TEMPERATURES:
        if _is_good(s, s.temperatures, payload, f.temperatures.length, data_id):
            s.winding_temperature = extracted(payload, f.temperatures.winding)
            s.inverter_temperature = extracted(payload, f.temperatures.inverter)
    elif _is_good(s, s.faults, payload, f.faults.length, data_id):
        s.fault_bits = extracted(payload, f.faults.faults)
        s.warning_bits = extracted(payload, f.faults.warnings)
        s.error_code = extracted(payload, f.faults.error_code)


@compilable
def _is_good(s: Feedback, checked: checking.CheckState, payload: int, length: float, data_id: float) -> bool:
    status = checking.check(checking.TOLERANCES, checked, payload, int(length), int(data_id))
    if checking.is_valid(status):
        s.lost += checked.lost_data
        return True
    if status in (checking.WRONG_CRC, checking.REPEATED, checking.WRONG_SEQUENCE):
        s.refused += 1.0
    return False


_QUIET = 0.005  # s without torque, command or reset bit, with which a reset begins: its bit shall be seen to rise
_ALONE = 10.0  # cycles in which the other drive could have shown that it is released, too
MAY_BE_ENABLED, LATCHED, SILENT, WITHOUT_COMMAND, DOUBTFUL = range(5)


@compilable
def advance_gateway(p: GatewayParameters, s: Gateway, ticks: float, period: float) -> None:
    """Lead all devices over some ticks, `period` [s] in all, after the frames of this cycle."""
    if s.waits != 0.0:
        _enable_where_possible(p, s)
    advance_device(p, s.drive_11, period)
    advance_device(p, s.drive_12, period)
    advance_device(p, s.load_11, period)
    advance_device(p, s.load_12, period)
    if p.fault_stops == BOTH and (is_faulty(s.drive_11) or is_faulty(s.drive_12)):
        s.drive_11.enable = s.drive_12.enable = 0.0
    s.tick += ticks


@compilable
def _enable_where_possible(p: GatewayParameters, s: Gateway) -> None:
    """The load machines first: until they hold the shafts as commanded, the drives' measurements are in doubt.

    Then both drives together, or the one of them that follows its controlword by its own status.
    """
    if refusal(p, s.load_11) == MAY_BE_ENABLED:
        s.load_11.enable = 1.0
    if refusal(p, s.load_12) == MAY_BE_ENABLED:
        s.load_12.enable = 1.0
    right, left = s.drive_11.feedback.remote, s.drive_12.feedback.remote
    s.waits = s.waits + 1.0 if right != left else 1.0
    right_ready = right < left or refusal(p, s.drive_11) == MAY_BE_ENABLED
    left_ready = left < right or refusal(p, s.drive_12) == MAY_BE_ENABLED
    if right_ready and left_ready and (right == left or s.waits > _ALONE):
        s.drive_11.enable = 1.0 if right >= left else 0.0
        s.drive_12.enable = 1.0 if left >= right else 0.0
        s.waits = 0.0


@compilable
def advance_device(p: GatewayParameters, s: Device, period: float) -> None:
    """Note what is wrong and how a reset goes on, after the frames of this cycle; everything gets older by `period`."""
    if s.feedback.heard == 0.0:
        checking.no_new_data(s.feedback.motion)
    s.feedback.heard = 0.0
    state = int(s.feedback.state)
    if s.reset_time >= 0.0:
        _advance_reset(p, s, state, period)
    elif s.enable != 0.0:
        if s.feedback.age >= p.feedback_timeout - 0.5 * period:  # independent of how the age was rounded
            s.stale = 1.0
        elif state in (drive_states.FAULT, drive_states.FAULT_REACTION_ACTIVE):
            s.tripped = 1.0
        if s.command_age >= p.command_timeout - 0.5 * period:
            s.command_stale = 1.0
        if is_faulty(s):
            s.enable = 0.0
    s.feedback.age += period
    s.command_age += period


@compilable
def is_faulty(s: Device) -> bool:
    """Whether a fault is latched here; only a reset clears it."""
    return s.tripped != 0.0 or s.stale != 0.0 or s.command_stale != 0.0 or s.implausible != 0.0


@compilable
def _advance_reset(p: GatewayParameters, s: Device, state: int, period: float) -> None:
    """It has succeeded when a fresh statusword, after the bit was sent, is without fault."""
    fresh = s.feedback.age <= p.feedback_timeout
    s.reset_time += period
    if s.reset_time > 2.0 * _QUIET and fresh and state == drive_states.SWITCH_ON_DISABLED:
        s.tripped = s.stale = s.command_stale = s.implausible = s.doubtful_time = 0.0
        s.reset_time = -1.0
    elif s.reset_time > p.reset_timeout:
        s.reset_time = -1.0


@compilable
def refusal(p: GatewayParameters, s: Device) -> int:
    """Why a device may not be enabled now."""
    if is_faulty(s):
        return LATCHED
    if s.feedback.age > p.feedback_timeout:
        return SILENT
    if s.doubtful_time > 0.0:
        return DOUBTFUL
    return MAY_BE_ENABLED if s.command_age <= p.command_timeout else WITHOUT_COMMAND


@compilable
def begin_reset(s: Device) -> None:
    """Begin the reset sequence: nothing is enabled, then the reset bit."""
    s.enable = 0.0
    s.reset_time = 0.0


@compilable
def controlword(s: Device) -> int:
    """The controlword of the next set-point."""
    if s.reset_time >= 0.0:
        return drive_states.FAULT_RESET if s.reset_time > _QUIET else drive_states.DISABLE_VOLTAGE
    return (
        drive_states.controlword_towards_operation(int(s.feedback.state))
        if s.enable != 0.0
        else drive_states.DISABLE_VOLTAGE
    )


@compilable
def command_device(s: Device, mode: int, value: float) -> None:
    """What a device shall do: a torque [N m] or a speed [rad/s] at its shaft."""
    s.mode, s.command_age = float(mode), 0.0
    s.torque = value if mode == TORQUE_MODE else 0.0
    s.speed = value if mode != TORQUE_MODE else 0.0


@compilable
def set_point(f: BenchFrames, own: DeviceFrames, s: Device, torque_limit: float, speed_limit: float) -> int:
    """The payload of the next set-point, within limits [N m] and [rad/s] in every mode; its counter goes on.

    The command goes out where the device is enabled and its statusword confirms it. A torque goes with the speed limit.
    """
    most = most_torque(f.set_point, torque_limit)
    most_speed = rounded_down(f.set_point.speed, speed_limit / RPM)
    torque = min(max(s.torque, -most), most)
    speed = most_speed if int(s.mode) == TORQUE_MODE else min(max(s.speed / RPM, -most_speed), most_speed)
    turns = s.enable != 0.0 and int(s.feedback.state) == drive_states.OPERATION_ENABLED
    payload = inserted(0, f.set_point.mode, s.mode)
    payload = inserted(payload, f.set_point.controlword, float(controlword(s)))
    payload = inserted(payload, f.set_point.torque, torque if turns else 0.0)
    payload = inserted(payload, f.set_point.speed, speed if turns else 0.0)
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
