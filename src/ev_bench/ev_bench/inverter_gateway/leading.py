"""Leading an inverter through its states: feedback in, enable, stop at a fault, reset, frames out.

How it works: a device is a small state machine. Its state is a few entries of `Device`.

    off        enable is false: the controlword takes the voltage away.
    enabling   enable is true: each controlword takes the inverter one state nearer to operation, by
               its statusword (`drive_states.controlword_towards_operation`).
    running    enable is true and the statusword confirms it: torque or speed go out.
    latched    one of tripped, stale, command_stale, implausible is true: enable becomes false, and
               nothing but a reset clears it.
    reset      reset_time counts from 0 (-1: there is none). First nothing is sent for `_QUIET`,
               then the reset bit, which the inverter sees rise. A fresh statusword without fault
               after that clears the latches; else the reset ends at `reset_timeout`.

Each cycle has three steps: `receive_feedback` takes the frames that have come, as far as they are
valid; `advance_gateway` notes what is wrong and goes on with resets; `set_point` and `heartbeat`
make the frames that go out. With `waits` the gateway enables the drives by itself as soon as
nothing speaks against it (`_enable_where_possible`).
"""

from typing import NamedTuple

from ev_bench.bus import checking
from ev_bench.inverter_gateway.gateway import (
    Device,
    Feedback,
    Gateway,
    GatewayParameters,
    Stops,
    most_torque,
)
from ev_msgs_py.can import drive_states
from ev_msgs_py.can.frames import RPM, SENT, TORQUE_MODE, BenchFrames, DeviceFrames, guarded
from ev_msgs_py.can.payload import extracted, inserted, next_counter, rounded_down
from ev_msgs_py.compilable import compilable

MOTION, ELECTRICAL, TEMPERATURES, FAULTS = range(len(SENT))
MAY_BE_ENABLED, LATCHED, SILENT, WITHOUT_COMMAND, DOUBTFUL = range(5)  # of `refusal`
_QUIET = 0.005  # s of a reset without torque, command or reset bit, so that its bit is seen to rise
_ALONE = 10.0  # cycles in which the other drive could have shown that it is released, too


@compilable
def receive_feedback(
    f: BenchFrames, own: DeviceFrames, s: Feedback, kind: int, payload: int
) -> None:
    """Take a frame of this device; what is not valid is counted."""
    data_id = own.data_ids[kind]
    if kind == MOTION:
        s.received = True
        if _is_good(s, s.motion, payload, f.motion.length, data_id):
            word = int(extracted(payload, f.motion.statusword))
            s.age = 0.0
            s.state = float(drive_states.state_of(word))
            s.remote = word & drive_states.REMOTE != 0
            s.torque = extracted(payload, f.motion.torque)
            # The transducer shows means, so means are compared (`gateway.watch`).
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
def _is_good(
    s: Feedback, checked: checking.CheckState, payload: int, length: float, data_id: float
) -> bool:
    status = checking.check(checking.TOLERANCES, checked, payload, int(length), int(data_id))
    if checking.is_valid(status):
        s.lost += checked.lost_data
        return True
    if status in (checking.WRONG_CRC, checking.REPEATED, checking.WRONG_SEQUENCE):
        s.refused += 1.0
    return False


@compilable
def advance_gateway(p: GatewayParameters, s: Gateway, ticks: float, period: float) -> None:
    """Lead all devices over some ticks, `period` [s] in all, after the frames of this cycle."""
    # Enabling by itself goes on until it has succeeded once.
    if s.waits:
        _enable_where_possible(p, s)
        s.waited += period
    advance_device(p, s.drive_11, period)
    advance_device(p, s.drive_12, period)
    advance_device(p, s.load_11, period)
    advance_device(p, s.load_12, period)
    if p.fault_stops == Stops.BOTH and (is_faulty(s.drive_11) or is_faulty(s.drive_12)):
        s.drive_11.enable = False
        s.drive_12.enable = False
    s.tick += ticks


@compilable
def _enable_where_possible(p: GatewayParameters, s: Gateway) -> None:
    """Enable the load machines first: until they hold the shafts, the drives are in doubt.

    Then both drives together, or the one of them that follows its controlword by its own status.
    """
    if refusal(p, s.load_11) == MAY_BE_ENABLED:
        s.load_11.enable = True
    if refusal(p, s.load_12) == MAY_BE_ENABLED:
        s.load_12.enable = True
    right, left = s.drive_11.feedback.remote, s.drive_12.feedback.remote
    # It counts the cycles for which one drive alone follows its controlword.
    s.waits = s.waits + 1.0 if right != left else 1.0
    # A drive that does not follow its controlword need not be ready.
    right_ready = right < left or refusal(p, s.drive_11) == MAY_BE_ENABLED
    left_ready = left < right or refusal(p, s.drive_12) == MAY_BE_ENABLED
    if right_ready and left_ready and (right == left or s.waits > _ALONE):
        s.drive_11.enable = right >= left
        s.drive_12.enable = left >= right
        s.waits = 0.0


@compilable
def advance_device(p: GatewayParameters, s: Device, period: float) -> None:
    """Latch what is wrong and go on with a reset, after the frames of this cycle."""
    # The check counts cycles without a frame, by which it later tolerates a gap.
    if not s.feedback.received:
        checking.no_new_data(s.feedback.motion)
    s.feedback.received = False
    state = int(s.feedback.state)
    if s.reset_time >= 0.0:
        _advance_reset(p, s, state, period)
    elif s.enable:
        # Half a period less makes it independent of how the age was rounded.
        if s.feedback.age >= p.feedback_timeout - 0.5 * period:
            s.stale = True
        elif state in (drive_states.FAULT, drive_states.FAULT_REACTION_ACTIVE):
            s.tripped = True
        if s.command_age >= p.command_timeout - 0.5 * period:
            s.command_stale = True
        if is_faulty(s):
            s.enable = False
    s.feedback.age += period
    s.command_age += period


@compilable
def is_faulty(s: Device) -> bool:
    """Return true if a fault is latched, here or in the inverter; only a reset clears it."""
    # One from before counts as well: the other drive alone would turn the car.
    if int(s.feedback.state) in (drive_states.FAULT, drive_states.FAULT_REACTION_ACTIVE):
        return True
    return bool(s.tripped or s.stale or s.command_stale or s.implausible)


@compilable
def _advance_reset(p: GatewayParameters, s: Device, state: int, period: float) -> None:
    """Go on with a reset: a fresh statusword without fault, after the bit was sent, ends it."""
    fresh = s.feedback.age <= p.feedback_timeout
    s.reset_time += period
    # As long again with the reset bit: what the statusword shows now, it shows after the bit.
    if s.reset_time > 2.0 * _QUIET and fresh and state == drive_states.SWITCH_ON_DISABLED:
        s.tripped = False
        s.stale = False
        s.command_stale = False
        s.implausible = False
        s.doubtful_time = 0.0
        s.reset_time = -1.0
    elif s.reset_time > p.reset_timeout:
        s.reset_time = -1.0


@compilable
def refusal(p: GatewayParameters, s: Device) -> int:
    """Reason why a device may not be enabled now, MAY_BE_ENABLED if there is none."""
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
    s.enable = False
    s.reset_time = 0.0


@compilable
def controlword(s: Device) -> int:
    """Controlword of the next set-point."""
    if s.reset_time >= 0.0:
        return drive_states.FAULT_RESET if s.reset_time > _QUIET else drive_states.DISABLE_VOLTAGE
    if s.enable:
        return drive_states.controlword_towards_operation(int(s.feedback.state))
    return drive_states.DISABLE_VOLTAGE


@compilable
def command_device(s: Device, mode: int, value: float) -> None:
    """Command a device: a torque [N m] or a speed [rad/s] at its shaft."""
    s.mode = float(mode)
    s.command_age = 0.0
    s.torque = value if mode == TORQUE_MODE else 0.0
    s.speed = value if mode != TORQUE_MODE else 0.0


class Limits(NamedTuple):
    """Limits of a device at its shaft, in every mode."""

    torque: float  # [N m]
    speed: float  # [rad/s]


@compilable
def set_point(f: BenchFrames, own: DeviceFrames, s: Device, limits: Limits) -> int:
    """Payload of the next set-point, within limits in every mode; its counter goes on.

    The command goes out where the device is enabled and its statusword confirms it. A torque goes
    with the speed limit.
    """
    most = most_torque(f.set_point, limits.torque)
    most_speed = rounded_down(f.set_point.speed, limits.speed / RPM)
    torque = min(max(s.torque, -most), most)
    speed = most_speed
    if int(s.mode) != TORQUE_MODE:
        speed = min(max(s.speed / RPM, -most_speed), most_speed)
    # An inverter that is not in operation must not find a torque when it gets there.
    turns = s.enable and int(s.feedback.state) == drive_states.OPERATION_ENABLED
    payload = inserted(0, f.set_point.mode, s.mode)
    payload = inserted(payload, f.set_point.controlword, float(controlword(s)))
    payload = inserted(payload, f.set_point.torque, torque if turns else 0.0)
    payload = inserted(payload, f.set_point.speed, speed if turns else 0.0)
    payload = inserted(payload, f.set_point.torque_limit, most if turns else 0.0)
    # It counts frames that go out, whether the device is enabled or not.
    counter = int(s.counter)
    s.counter = float(next_counter(counter))
    return guarded(f.set_point, payload, own.set_point_data_id, counter)


@compilable
def heartbeat(f: BenchFrames, s: Gateway, place: int) -> int:
    """Payload of the next heartbeat of a circuit; its counter goes on."""
    of_drives = max(s.drive_11.command_stale, s.drive_12.command_stale)
    of_loads = max(s.load_11.command_stale, s.load_12.command_stale)
    latched = max(of_drives, of_loads)
    # One bit for each device, drives first.
    stale = s.drive_11.stale + 2.0 * s.drive_12.stale
    stale += 4.0 * s.load_11.stale + 8.0 * s.load_12.stale
    enable = s.drive_11.enable + 2.0 * s.drive_12.enable
    enable += 4.0 * s.load_11.enable + 8.0 * s.load_12.enable
    implausible = s.drive_11.implausible + 2.0 * s.drive_12.implausible
    payload = inserted(0, f.heartbeat.command_stale, latched)
    payload = inserted(payload, f.heartbeat.implausible, implausible)
    payload = inserted(payload, f.heartbeat.stale, stale)
    payload = inserted(payload, f.heartbeat.enable, enable)
    counter = int(s.heartbeat_counters[place])
    s.heartbeat_counters[place] = float(next_counter(counter))
    return guarded(f.heartbeat, payload, f.ecu_data_id, counter)
