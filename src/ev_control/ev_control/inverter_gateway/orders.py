"""What the graph asks of the gateway at an instant, and what somebody does at its buttons."""

from __future__ import annotations

from ev_control.inverter_gateway.leading import begin_reset, command_device, is_faulty
from ev_control.inverter_gateway.parameters import LockstepGatewayParameters
from ev_control.inverter_gateway.plausibility import watch
from ev_control.inverter_gateway.state import Device, Gateway
from ev_core.law import BenchShafts, LoadCommand, WheelTorqueCommand, compilable, inlined, isfinite
from ev_msgs_py.can.frames import SPEED_MODE, TORQUE_MODE


@inlined
def command_drives(p: LockstepGatewayParameters, g: Gateway, command: WheelTorqueCommand) -> None:
    """Torques of the drives."""
    _command(p, g.drive_11, TORQUE_MODE, command.drive[int(p.wheel_11)] / p.gear_ratio)
    _command(p, g.drive_12, TORQUE_MODE, command.drive[int(p.wheel_12)] / p.gear_ratio)


@inlined
def command_loads(p: LockstepGatewayParameters, g: Gateway, load: LoadCommand) -> None:
    """Torques or speeds of the load machines."""
    _command_load(p, g.load_11, load, int(p.wheel_11))
    _command_load(p, g.load_12, load, int(p.wheel_12))


@inlined
def watch_bench(
    p: LockstepGatewayParameters, rotor: float, g: Gateway, load: LoadCommand, shafts: BenchShafts, period: float
) -> None:
    """Whether the bench measures what can be, once all frames of a period were heard; rotors of an inertia [kg m^2]."""
    right, left = int(p.wheel_11), int(p.wheel_12)
    watch(p.plausibility, g.drive_11, rotor, shafts.torque[right], shafts.speed[right], load.speed[right], period)
    watch(p.plausibility, g.drive_12, rotor, shafts.torque[left], shafts.speed[left], load.speed[left], period)


@compilable
def _command(p: LockstepGatewayParameters, s: Device, mode: int, value: float) -> None:
    """A torque [N m] or a speed [rad/s] at the shaft; what is no number is no command."""
    if isfinite(value):
        command_device(p, s, mode, value)


@compilable
def _command_load(p: LockstepGatewayParameters, s: Device, load: LoadCommand, wheel: int) -> None:
    """What the virtual car asks of a load machine; in torque mode what brakes counts forwards there."""
    if int(load.mode[wheel]) == SPEED_MODE:
        _command(p, s, SPEED_MODE, load.speed[wheel])
    else:
        _command(p, s, TORQUE_MODE, -load.torque[wheel])


@compilable
def press_buttons(enable_tick: float, reset_tick: float, g: Gateway) -> None:
    """Enable, or reset and enable after it, where the present tick is the one."""
    if g.tick == enable_tick:
        g.waits = 1.0
    if g.tick == reset_tick:
        begin_reset(g.drive_11)
        begin_reset(g.drive_12)
        if is_faulty(g.load_11):
            begin_reset(g.load_11)
        if is_faulty(g.load_12):
            begin_reset(g.load_12)
        g.waits = 1.0
