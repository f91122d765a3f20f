"""The cycle of both inverters of a circuit behind a bus, modelled or real: machines and shaft over 1 ms."""

from __future__ import annotations

from typing import NamedTuple

from ev_msgs_py.can.bus_model import ChannelFrames
from ev_msgs_py.can.drive_states import DISABLE_VOLTAGE, OPERATION_ENABLED
from ev_msgs_py.can.frames import BenchFrames
from ev_msgs_py.can.schedule import TICK
from ev_msgs_py.compiling.compilable import compilable
from ev_sim.inverter.inverter import end_inverter_cycle, lead_inverter
from ev_sim.test_bench.can_parameters import CanCircuitsParameters
from ev_sim.test_bench.circuit import CircuitsConstants, follow_of_load, largest_torques, send_to_load, turn_shaft
from ev_sim.test_bench.parameters import BOTH, LEFT, RIGHT
from ev_sim.test_bench.set_points import follow, send
from ev_sim.test_bench.state import CircuitState


class CanConstants(NamedTuple):
    """What is computed once."""

    circuits: CircuitsConstants
    ticks: float  # of 1 ms in a control period
    steps: float  # of the shafts in a tick
    frames: BenchFrames
    channel_11: ChannelFrames
    channel_12: ChannelFrames
    right: float  # place of its wheel
    left: float


@compilable
def make_cycle(
    p: CanCircuitsParameters, c: CanConstants, number: int, s: CircuitState, now: float, limited: bool
) -> None:
    """The cycle of both inverters after their set-points have come: states, machines and shaft, warnings.

    The operator's enabling of a circuit is a line of its own beside the bus: without it nothing is switched on.
    """
    machine = c.circuits.machine
    released = p.enabled == BOTH or p.enabled == (RIGHT if number == 0 else LEFT)
    s.machine.remote = s.load.remote = 1.0 if released else 0.0
    if not released:
        s.machine.command.controlword = s.load.command.controlword = float(DISABLE_VOLTAGE)
    lead_inverter(machine, s.machine, s.speed, TICK)
    lead_inverter(p.load, s.load, s.load_speed, TICK)
    _follow(p, c, s, now, limited)
    end_inverter_cycle(machine, s.machine, TICK)
    end_inverter_cycle(p.load, s.load, TICK)


@compilable
def _follow(p: CanCircuitsParameters, c: CanConstants, s: CircuitState, now: float, limited: bool) -> None:
    """The machines and the shaft over a tick; the inverters take what has arrived as they would without a bus."""
    machine, load, path, steps = s.machine, s.load, s.torque_path, int(c.steps)
    asked, asked_load, asked_speed, limit = (
        machine.command.torque, load.command.torque, load.command.speed, load.command.torque_limit
    )  # fmt: skip
    change = c.circuits.h * p.set_point.torque_rate
    send(path, now, asked, c.circuits.machine.machine.peak_torque, p.set_point.torque_resolution)
    send_to_load(p, s, now, -asked_load, asked_speed)
    if limited:
        load.command.torque_limit = p.inject.value
    largest = largest_torques(p, c.circuits, s)
    for n in range(steps):
        machine.command.torque = follow(path, now, steps, n, c.circuits.delay, change)
        follow_of_load(p, c.circuits, s, now, steps, n)
        if machine.state != OPERATION_ENABLED:
            path.now = 0.0
        turn_shaft(p, c.circuits, s, largest)
    machine.command.torque = asked
    load.command.torque, load.command.speed, load.command.torque_limit = asked_load, asked_speed, limit
