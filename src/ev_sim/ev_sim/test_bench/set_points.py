"""From a set-point of the controller to what an inverter follows: resolution, delay, rate limit."""

from __future__ import annotations

from typing import NamedTuple

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.contract.bench_signals import LoadCommand
from ev_msgs_py.contract.signals import WheelTorqueCommand
from ev_msgs_py.contract.wheels import Wheels
from ev_msgs_py.elementary import floor, remainder
from ev_msgs_py.vehicle.car import Car
from ev_sim.test_bench.state import LINE, SetPointState


class SetPoints(NamedTuple):
    """What the inverters of all circuits are told in a period: the one way into the bench.

    Here, between controller and inverters, is the place of a bus. The way out is `circuits.outputs`.
    """

    torque: Wheels  # of the machines under test, at the shaft [N m]
    load_mode: Wheels  # TORQUE_MODE or SPEED_MODE of the load machines
    load_torque: Wheels  # of the load machines, positive against forwards [N m]
    load_speed: Wheels  # of the load machines [rad/s]


@compilable
def set_points(car: Car, command: WheelTorqueCommand, load: LoadCommand) -> SetPoints:
    """The set-points of a period: torque at the shaft is torque at the wheel over the gear ratio (section 4.1)."""
    torque, gear = command.drive, car.gear_ratio
    shaft = Wheels(torque[0] / gear, torque[1] / gear, torque[2] / gear, torque[3] / gear)
    return SetPoints(shaft, load.mode, load.torque, load.speed)


@compilable
def send(path: SetPointState, periods: float, value: float, largest: float, resolution: float) -> None:
    """Let a set-point set out, within its range and rounded; at the start everything was zero."""
    sent = min(max(value, -largest), largest)
    # What came over a bus is mostly such a multiple already.
    if resolution > 0.0 and resolution * floor(sent / resolution + 0.5) != sent:
        sent -= remainder(sent, resolution)
    path.line[int(periods) % LINE] = sent


@compilable
def follow(path: SetPointState, periods: float, steps: int, step: int, delay: float, change: float) -> float:
    """What an inverter follows in a step of a period, `delay` in steps; it changes by `change` at most.

    The step in which a set-point arrives gets its share of the old and of the new one.
    """
    whole = int(delay)
    late = delay - whole
    asked = _sent(path, periods, steps, step - whole)
    if late > 0.0:
        asked += late * (_sent(path, periods, steps, step - whole - 1) - asked)
    path.now += min(max(asked - path.now, -change), change)
    return path.now


@compilable
def _sent(path: SetPointState, periods: float, steps: int, step: int) -> float:
    """The set-point of the period in which a step lies, which is counted from the beginning of the present one."""
    back = 0 if step >= 0 else (steps - 1 - step) // steps
    period = int(periods) - back
    return path.line[period % LINE] if period >= 0 else 0.0
