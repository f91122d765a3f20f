"""One circuit of the bench: machine under test, shaft with transducer, load machine.

How it works: a set-point goes into a ring of the last periods (`send`), and is followed late and
not faster than its rate (`follow`). In each step both torques follow, the shaft between the rotors
turns (`turn`), and energies are booked (`_account`). Heat and electrical quantities follow once in
a period (`end_period`).
"""

from __future__ import annotations

from typing import NamedTuple

from ev_bench.inverter.device import InverterParameters
from ev_bench.inverter.power_stage import (
    advance_electrical,
    advance_temperatures,
    follow_reference,
    largest_torque,
)
from ev_bench.machines.described import (
    KEPT_SET_POINTS,
    CircuitsParameters,
    CircuitState,
    SetPointState,
    ShaftParameters,
)
from ev_core.law import compilable, floor, inlined, remainder
from ev_core.vehicle.losses import loss_power
from ev_msgs_py.can.drive_states import OPERATION_ENABLED, SWITCH_ON_DISABLED
from ev_msgs_py.can.frames import SPEED_MODE, TORQUE_MODE

_NO_LIMIT = 2.0  # times its largest speed: the machine's own limit comes first


class Motion(NamedTuple):
    """Over one step: torque in the shaft [N m], and the mean speeds of both machines [rad/s]."""

    torque: float
    speed: float
    load_speed: float


@inlined
def turn(
    p: ShaftParameters,
    s: CircuitState,
    inertia: float,
    load_inertia: float,
    torque: float,
    load: float,
    h: float,
) -> Motion:
    """Turn two rotors by torques that are held over h [s], forwards positive.

        J_1 w_1' = M_1 - M
        J_2 w_2' = M + M_2 - b w_2
        M = k theta + d (w_1 - w_2)
        theta' = w_1 - w_2

    Implicit midpoint rule: stable for any stiffness, and work = heat + what is stored, up to
    rounding.
    """
    # The midpoint rule is linear in both mean speeds; put into the torque of the shaft they leave
    # one equation for it.
    free, free_load = 0.5 * h / inertia, 0.5 * h / load_inertia
    slowed = 1.0 + free_load * p.friction
    yielding = 0.5 * h * p.stiffness + p.damping
    apart = s.speed + free * torque - (s.load_speed + free_load * load) / slowed
    shaft = (p.stiffness * s.twist + yielding * apart) / (
        1.0 + yielding * (free + free_load / slowed)
    )
    mean = s.speed + free * (torque - shaft)
    mean_load = (s.load_speed + free_load * (shaft + load)) / slowed
    s.twist += h * (mean - mean_load)
    # The mean is that of begin and end, so the end lies as far beyond it.
    s.speed += 2.0 * (mean - s.speed)
    s.load_speed += 2.0 * (mean_load - s.load_speed)
    return Motion(shaft, mean, mean_load)


@compilable
def send(
    path: SetPointState, periods: float, value: float, largest: float, resolution: float
) -> None:
    """Let a set-point set out, within its range and rounded; at the start everything was zero."""
    sent = min(max(value, -largest), largest)
    # What came over a bus is mostly such a multiple already.
    if resolution > 0.0 and resolution * floor(sent / resolution + 0.5) != sent:
        sent -= remainder(sent, resolution)
    path.line[int(periods) % KEPT_SET_POINTS] = sent


@compilable
def follow(
    path: SetPointState, periods: float, steps: int, step: int, delay: float, change: float
) -> float:
    """Set-point that an inverter follows in a step: `delay` in steps, `change` at most.

    The step in which a set-point arrives gets its share of the old and of the new one.
    """
    # A delay need not be a whole number of steps: in between, both neighbours have their share.
    whole = int(delay)
    late = delay - whole
    asked = _sent(path, periods, steps, step - whole)
    if late > 0.0:
        asked += late * (_sent(path, periods, steps, step - whole - 1) - asked)
    path.now += min(max(asked - path.now, -change), change)
    return path.now


@compilable
def _sent(path: SetPointState, periods: float, steps: int, step: int) -> float:
    """Set-point of the period in which a step lies, counted from the beginning of this one."""
    # Steps below 0 lie in the periods before: -1 to -steps in the last one.
    back = 0 if step >= 0 else (steps - 1 - step) // steps
    period = int(periods) - back
    return path.line[period % KEPT_SET_POINTS] if period >= 0 else 0.0


class CircuitsConstants(NamedTuple):
    """Constants of a circuit that are computed once."""

    h: float  # width of a step [s]
    steps: float  # in a control period
    delay: float  # of the set-points of the machines under test [steps]
    load_delay: float  # of those of the load machines [steps]
    share: float  # of a difference of torque that a machine under test closes in a step [1]
    load_share: float  # that a load machine closes [1]
    machine: InverterParameters  # machine under test


class LargestTorques(NamedTuple):
    """Largest torques of both machines [N m] while temperatures and limits stay."""

    machine: float
    load: float


class CircuitSetPoint(NamedTuple):
    """Inputs of the two inverters of a circuit for a period: the one way into the bench.

    Here, between controller and inverters, is the place of a bus. The way out is
    `circuits.outputs`.
    """

    torque: float  # of the machine under test, at the shaft [N m]
    load_mode: float  # TORQUE_MODE or SPEED_MODE of the load machine
    load_torque: float  # of the load machine, positive against forwards [N m]
    load_speed: float  # of the load machine [rad/s]


@compilable
def power(s: CircuitState, enabled: bool, voltage: float, load_voltage: float) -> None:
    """Supply both inverters [V] and enable or disable them; without a bus nothing else does."""
    s.machine.state = s.load.state = float(OPERATION_ENABLED if enabled else SWITCH_ON_DISABLED)
    s.machine.dc_link.voltage, s.load.dc_link.voltage = voltage, load_voltage


@compilable
def advance_circuit(
    p: CircuitsParameters,
    c: CircuitsConstants,
    s: CircuitState,
    periods: float,
    given: CircuitSetPoint,
    period: float,
) -> None:
    """One control period of a circuit."""
    machine, most = c.machine.machine, c.machine.machine.peak_torque
    send(s.torque_path, periods, given.torque, most, p.set_point.torque_resolution)
    s.machine.command.mode, s.machine.command.torque_limit = float(TORQUE_MODE), most
    s.machine.command.speed = _NO_LIMIT * machine.maximum_speed
    s.load.command.mode, s.load.command.torque_limit = given.load_mode, p.load.machine.peak_torque
    send_to_load(p, s, periods, given.load_torque, given.load_speed)
    begin_period(s)
    steps, rate, largest = int(c.steps), c.h * p.set_point.torque_rate, largest_torques(p, c, s)
    for n in range(steps):
        s.machine.command.torque = follow(s.torque_path, periods, steps, n, c.delay, rate)
        follow_of_load(p, c, s, periods, steps, n, p.load.machine.maximum_speed)
        turn_shaft(p, c, s, largest)
    end_period(p, c, s, period)


@compilable
def begin_period(s: CircuitState) -> None:
    """Begin the means."""
    s.mean_torque = s.mean_load_torque = s.mean_shaft_torque = s.power = s.load_power = 0.0


@compilable
def end_period(p: CircuitsParameters, c: CircuitsConstants, s: CircuitState, period: float) -> None:
    """Compute once in a control period: electrical quantities and heat of both machines."""
    advance_electrical(c.machine, s.machine, s.speed)
    advance_electrical(p.load, s.load, s.load_speed)
    advance_temperatures(c.machine.thermal, c.machine.machine, s.machine, period)
    advance_temperatures(p.load.thermal, p.load.machine, s.load, period)


@compilable
def send_to_load(
    p: CircuitsParameters, s: CircuitState, cycle: float, torque: float, speed: float
) -> None:
    """Release the set-points of a load machine: torque against forwards [N m], speed [rad/s]."""
    load = p.load.machine
    send(s.load_torque_path, cycle, torque, load.peak_torque, p.load_set_point.torque_resolution)
    send(s.load_speed_path, cycle, speed, load.maximum_speed, p.load_set_point.speed_resolution)


@compilable
def follow_of_load(
    p: CircuitsParameters,
    c: CircuitsConstants,
    s: CircuitState,
    cycle: float,
    steps: int,
    n: int,
    limit: float,
) -> None:
    """Torque that the load inverter follows in step n of a cycle; it ends at a `limit` [rad/s]."""
    rate, acceleration = c.h * p.load_set_point.torque_rate, c.h * p.load_set_point.speed_rate
    command = s.load.command
    command.torque = -follow(s.load_torque_path, cycle, steps, n, c.load_delay, rate)
    asked_speed = follow(s.load_speed_path, cycle, steps, n, c.load_delay, acceleration)
    in_speed_mode = int(command.mode) == SPEED_MODE
    command.speed = asked_speed if in_speed_mode else limit


@compilable
def largest_torques(p: CircuitsParameters, c: CircuitsConstants, s: CircuitState) -> LargestTorques:
    """Torques of both machines now."""
    return LargestTorques(
        largest_torque(c.machine, s.machine, s.speed), largest_torque(p.load, s.load, s.load_speed)
    )


@compilable
def turn_shaft(
    p: CircuitsParameters, c: CircuitsConstants, s: CircuitState, largest: LargestTorques
) -> None:
    """One step: torques, shaft, energies."""
    h, drive, load = c.h, s.machine, s.load
    before, load_before = drive.torque, load.torque
    follow_reference(c.machine, drive, s.speed, h, c.share, largest.machine)
    follow_reference(p.load, load, s.load_speed, h, c.load_share, largest.load)
    # The mean over the step is what turns the shaft, and what is booked.
    torque, load_torque = 0.5 * (before + drive.torque), 0.5 * (load_before + load.torque)
    inertia, load_inertia = c.machine.machine.rotor_inertia, p.load.machine.rotor_inertia
    moved = turn(p.shaft, s, inertia, load_inertia, torque, load_torque, h)
    _account(p, c, s, moved, torque, load_torque)


@compilable
def _account(
    p: CircuitsParameters,
    c: CircuitsConstants,
    s: CircuitState,
    moved: Motion,
    torque: float,
    load_torque: float,
) -> None:
    """Book means and energies of a step.

    What the load machine gives goes into the load resistor, what it takes comes from the mains
    (section 4.2).
    """
    h, share = c.h, 1.0 / c.steps
    loss = loss_power(c.machine.machine, torque, moved.speed) + s.machine.weakening_loss
    load_loss = loss_power(p.load.machine, load_torque, moved.load_speed) + s.load.weakening_loss
    power, load_power = torque * moved.speed + loss, load_torque * moved.load_speed + load_loss
    twisting = moved.speed - moved.load_speed
    s.mean_torque += share * torque
    s.mean_load_torque += share * load_torque
    s.mean_shaft_torque += share * moved.torque
    s.power += share * power
    s.load_power += share * load_power
    s.battery += h * power
    s.machine_heat += h * loss
    s.load_heat += h * load_loss
    s.shaft_heat += h * (
        p.shaft.damping * twisting * twisting
        + p.shaft.friction * moved.load_speed * moved.load_speed
    )
    # The source feeds nothing back into the mains.
    if load_power >= 0.0:
        s.mains += h * load_power
    else:
        s.resistor -= h * load_power


@compilable
def stored_energy(p: CircuitsParameters, c: CircuitsConstants, s: CircuitState) -> float:
    """Energy of the turning rotors and of the twisted shaft [J]."""
    turning = c.machine.machine.rotor_inertia * s.speed * s.speed
    load_turning = p.load.machine.rotor_inertia * s.load_speed * s.load_speed
    return 0.5 * (turning + load_turning + p.shaft.stiffness * s.twist * s.twist)
