"""One circuit of the bench by itself."""

from __future__ import annotations

from itertools import pairwise
from math import atan, pi, sqrt

import pytest

from ev_bench.machines.circuit import turn
from ev_bench.machines.described import CircuitState, ShaftParameters
from ev_core.lockstep.configuration import configure
from ev_core.methods.law import namespace
from ev_core.parameters.declaration import number_tree
from ev_core.vehicle.losses import loss_power
from ev_core.vehicle.motor import Motor
from ev_msgs_py.can.frames import SPEED_MODE, TORQUE_MODE
from ev_msgs_py.contract.optional_signals import LoadCommand
from ev_msgs_py.contract.signals import BatteryCondition, WheelTorqueCommand
from ev_msgs_py.contract.wheels import NO_WHEELS, Wheels
from ev_msgs_py.refusal import ParameterError
from ev_sim.drives.synchronous_motor import weakening_loss

BATTERY, LOW = (BatteryCondition(voltage, 0.0, 30.0, 60.0, 0.5) for voltage in (400.0, 40.0))
GEAR = 2.65  # of the default vehicle


def bench(**values):
    return configure("test_bench", {"vehicle.motor.rotor_inertia": 0.02, **values}).create()


def run(circuits, torque, load, periods, battery=BATTERY):
    """Channels after some periods with front drive torques [N m] and a load command."""
    command = WheelTorqueCommand(Wheels.front(torque, torque), NO_WHEELS)
    for _ in range(periods):
        circuits.advance(command, load, battery)
    return circuits.outputs()


def test_torque_against_torque_accelerates_both_rotors():
    """(M_em - M_nu)/(J_1 + J_2) = (50 - 38)/(0.02 + 0.1) = 100 rad/s^2, without friction."""
    load = LoadCommand(Wheels.front(TORQUE_MODE, TORQUE_MODE), NO_WHEELS, Wheels.front(38.0, 38.0))
    circuits = bench(**{"shaft.friction": 0.0})
    first = run(circuits, 50.0 * GEAR, load, 20)[0]
    shafts = run(circuits, 50.0 * GEAR, load, 100)[0]
    assert shafts.speed.front_left - first.speed.front_left == pytest.approx(100.0, rel=1e-3)
    # The transducer sees what is left behind the rotor of the machine: 50 - 0.02 * 100.
    assert shafts.torque.front_left == pytest.approx(48.0, rel=1e-3)
    assert shafts.speed.rear_left == shafts.torque.rear_right == 0.0


def test_the_load_machine_holds_a_speed():
    """It takes what the machine gives, but for the friction of the bearings."""
    load = LoadCommand(Wheels.front(SPEED_MODE, SPEED_MODE), Wheels.front(200.0, 200.0), NO_WHEELS)
    shafts, electrical, temperatures, energy = run(bench(), 60.0 * GEAR, load, 120)
    assert shafts.load_speed.front_left == pytest.approx(200.0, abs=1e-3)
    assert shafts.torque.front_left == pytest.approx(60.0, abs=1e-3)
    assert shafts.load_torque.front_left == pytest.approx(0.002 * 200.0 - 60.0, abs=1e-3)
    assert electrical.load_current.front_left < 0.0 < electrical.current.front_left
    assert temperatures.coolant_out.front_left > temperatures.coolant_in.front_left == 40.0
    assert energy.resistor > 0.0


def test_a_load_machine_at_its_limit_gives_way():
    """Section 4.1: normally M_nu is above M_em.

    Where it is not, the shaft runs away from the wanted speed.
    """
    load = LoadCommand(Wheels.front(SPEED_MODE, SPEED_MODE), Wheels.front(50.0, 50.0), NO_WHEELS)
    shafts, *_ = run(bench(**{"load.machine.generator_torque": 40.0}), 60.0 * GEAR, load, 100)
    assert shafts.load_torque.front_left == pytest.approx(-40.0)
    assert shafts.load_speed.front_left > 150.0


def test_energy_comes_and_goes_without_a_rest():
    """Battery + mains = resistor + heat + stored, up to rounding, also while everything swings."""
    circuits = bench(**{"shaft.damping": 0.5})
    for torque, speed in ((100.0, 120.0), (-80.0, 60.0), (60.0, 200.0), (0.0, 0.0)):
        load = LoadCommand(
            Wheels.front(SPEED_MODE, SPEED_MODE), Wheels.front(speed, speed), NO_WHEELS
        )
        energy = run(circuits, torque * GEAR, load, 15)[3]
        gone = energy.resistor + energy.machines + energy.loads + energy.shafts + energy.stored
        assert energy.battery + energy.mains == pytest.approx(gone, rel=1e-10)
    assert min(energy) > 0.0


def test_field_weakening_takes_power_and_heats():
    """A tenth of the voltage at 200 rad/s needs it: the loss of i_d adds to the other losses."""
    circuits, load = (
        bench(),
        LoadCommand(Wheels.front(SPEED_MODE, SPEED_MODE), Wheels.front(200.0, 200.0), NO_WHEELS),
    )
    before = run(circuits, 20.0 * GEAR, load, 120, LOW)[3]
    shafts, _, _, energy = run(circuits, 20.0 * GEAR, load, 1, LOW)
    motor = Motor()  # of the default vehicle
    torque, speed = shafts.machine_torque.front_left, shafts.speed.front_left
    weakening = weakening_loss(motor, torque, LOW.voltage, speed)
    assert weakening > 100.0
    heat = 2.0 * 0.01 * (loss_power(motor, torque, speed) + weakening)
    assert energy.machines - before.machines == pytest.approx(heat, rel=1e-6)


def test_a_free_shaft_swings_at_its_frequency():
    """Two rotors on a spring: w^2 = k (1/J_1 + 1/J_2).

    Half a period after a twist it is twisted the other way.
    """
    stiffness, one, other = 2e4, 0.02, 0.1
    p, s = namespace(number_tree(ShaftParameters(stiffness, 0.0, 0.0))), CircuitState(twist=1e-3)
    half, steps = 3.141592653589793 / sqrt(stiffness * (1.0 / one + 1.0 / other)), 1000
    for _ in range(steps):
        turn(p, s, one, other, 0.0, 0.0, half / steps)
    assert s.twist == pytest.approx(-1e-3, rel=1e-6)
    assert one * s.speed + other * s.load_speed == pytest.approx(0.0, abs=1e-12)


def test_a_free_shaft_swings_too_slowly_at_the_default_step():
    """docs/test_bench.md.

    8.5 % at 1 ms, as the midpoint rule has it: w' = 2/h atan(w h/2), of 1095 rad/s here.
    """
    one, other, h = 0.02, 0.1, 1e-3
    p, s = (
        namespace(number_tree(ShaftParameters(damping=0.0, friction=0.0))),
        CircuitState(twist=1e-3),
    )
    exact = sqrt(p.stiffness * (1.0 / one + 1.0 / other))
    twists = [s.twist]
    for _ in range(2000):
        turn(p, s, one, other, 0.0, 0.0, h)
        twists.append(s.twist)
    swings = sum(before * after < 0.0 for before, after in pairwise(twists))
    # Half a swing more or less over the 640 of two seconds is 0.2 %.
    assert swings * pi / 2.0 / exact == pytest.approx(
        2.0 * atan(exact * h / 2.0) / (exact * h), rel=2e-3
    )
    assert swings * pi / 2.0 / exact == pytest.approx(1.0 - 0.085, abs=3e-3)


def test_delays_beyond_what_is_kept_are_refused():
    with pytest.raises(
        ParameterError, match=r"set_point.delay: 0\.7 is refused, expected at most 0\.62 s"
    ):
        bench(**{"set_point.delay": 0.7})
