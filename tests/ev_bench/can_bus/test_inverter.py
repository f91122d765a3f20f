"""An inverter and its machine behind their frames."""

from __future__ import annotations

import math
import random

import pytest
from can_bus.benches import NOTHING, SPEED, TICK, TORQUE, Bench
from can_bus.databases import ours

from ev_bench.inverter.circuit_station import advance_circuit
from ev_bench.inverter.device import Circuit, CircuitParameters
from ev_bench.inverter.on_channel import receive_set_point
from ev_core.compiled.loop import compiled, one_record
from ev_core.methods.law import namespace
from ev_core.parameters.declaration import number_tree
from ev_core.parameters.record import numbers
from ev_msgs_py.can.drive_states import (
    ENABLE_COMMAND,
    FAULT,
    FAULT_RESET,
    OPERATION_ENABLED,
    QUICK_STOP,
    QUICK_STOP_ACTIVE,
    READY_TO_SWITCH_ON,
    SHUTDOWN,
    SWITCH_ON_COMMAND,
    SWITCH_ON_DISABLED,
)
from ev_msgs_py.can.frame_length import Frame
from ev_msgs_py.can.frames import bench_frames
from ev_msgs_py.can.payload import protected

RUN = TORQUE | {"Controlword": float(ENABLE_COMMAND)}
RPM = math.pi / 30.0


def ticks_until(bench: Bench, state: int, limit: int = 3000, **values: float) -> int:
    for count in range(limit):
        if bench.state() == state:
            return count
        bench.cycle(**values)
    raise AssertionError(f"{bench.state()} after {limit} ticks")


def hold(bench: Bench, speed: float) -> None:
    """Let the load machine hold a speed [rpm] from now on."""
    bench.enable("Load11", **SPEED)
    bench.kept["Load11"] = SPEED | {"Speed": speed, "Controlword": float(ENABLE_COMMAND)}


def test_precharge_takes_three_time_constants():
    """95 % through 600 ohm into 440 uF take R C ln 20 = 0.791 s.

    Two cycles for the states around it.
    """
    bench = Bench()
    bench.cycle(ticks=5, **(TORQUE | {"Controlword": float(SHUTDOWN)}))
    assert bench.state() == READY_TO_SWITCH_ON
    count = ticks_until(bench, 3, **(TORQUE | {"Controlword": float(SWITCH_ON_COMMAND)}))
    assert count * TICK == pytest.approx(600.0 * 440e-6 * math.log(20.0), abs=2 * TICK)


def test_a_dc_link_that_does_not_charge_is_a_named_fault():
    bench = Bench(**{"drive.dc_link.capacitance": 0.1})
    bench.cycle(ticks=5, **(TORQUE | {"Controlword": float(SHUTDOWN)}))
    count = ticks_until(bench, FAULT, **(TORQUE | {"Controlword": float(SWITCH_ON_COMMAND)}))
    assert count * TICK == pytest.approx(2.0, abs=5 * TICK)
    bench.cycle(ticks=10)
    assert bench.received["Drive11_Faults"]["PrechargeTimeout"] == 1.0
    assert bench.received["Drive11_Faults"]["ErrorCode"] == 0xFF03


def test_torque_follows_with_its_time_constant():
    """63.2 % after tau = 2 ms, here two cycles; 1/32 N m is what the bus resolves."""
    bench = Bench()
    bench.enable()
    bench.cycle(ticks=2, **(RUN | {"Torque": 100.0}))
    assert bench.received["Drive11_Motion"]["Torque"] == pytest.approx(
        100.0 * (1.0 - math.exp(-1.0)), abs=1 / 64
    )


def test_the_shaft_accelerates_by_its_inertia():
    """120 N m on 0.12 kg m^2 for 0.1 s, less the lag of the torque and, below 1 %, friction."""
    bench = Bench()
    bench.enable()
    bench.cycle(ticks=100, **(RUN | {"Torque": 120.0}))
    expected = 120.0 / 0.12 * (0.1 - 0.002)
    assert bench.circuit.speed == pytest.approx(expected, rel=0.015)
    assert bench.received["Drive11_Motion"]["Speed"] * RPM == pytest.approx(
        bench.circuit.speed, abs=0.5 * RPM
    )


def test_reverse_counts_the_other_way_round():
    bench = Bench()
    bench.enable(Direction=1.0)
    bench.cycle(ticks=20, **(RUN | {"Torque": 100.0, "Direction": 1.0}))
    assert bench.circuit.drive.torque < -99.0
    assert bench.circuit.speed < 0.0


def test_the_load_machine_holds_a_speed_against_the_machine_under_test():
    """Speed mode holds it to half a step of the bus."""
    bench = Bench()
    hold(bench, 1000.0)
    bench.enable()
    bench.cycle(ticks=3000, **(RUN | {"Torque": 50.0}))
    assert bench.received["Load11_Motion"]["Speed"] == pytest.approx(1000.0, abs=0.5)
    assert bench.received["Load11_Motion"]["Torque"] == pytest.approx(-50.0, abs=1.0)


def test_torque_never_exceeds_the_limits():
    """Both limits hold: that of the set-point (40 N m) and that of the machine (360 N m)."""
    bench = Bench()
    bench.enable()
    bench.cycle(ticks=30, **(RUN | {"Torque": 300.0, "TorqueLimit": 40.0}))
    assert bench.circuit.drive.torque == pytest.approx(40.0, abs=1e-3)
    bench.cycle(ticks=30, **(RUN | {"Torque": 1000.0, "TorqueLimit": 1000.0}))
    assert bench.circuit.drive.torque <= 360.0


def test_the_speed_limit_of_torque_mode_is_kept():
    bench = Bench()
    bench.enable()
    bench.cycle(ticks=1000, **(RUN | {"Torque": 200.0, "Speed": 500.0}))
    assert 450.0 < bench.received["Drive11_Motion"]["Speed"] <= 500.0


def test_quick_stop_takes_the_torque_away_and_then_the_voltage():
    bench = Bench()
    bench.enable()
    bench.cycle(ticks=20, **(RUN | {"Torque": 100.0}))
    bench.cycle(**(RUN | {"Torque": 100.0, "Controlword": float(QUICK_STOP)}))
    assert bench.state() == QUICK_STOP_ACTIVE
    assert ticks_until(bench, SWITCH_ON_DISABLED, **(RUN | {"Controlword": float(QUICK_STOP)})) < 12
    assert bench.circuit.drive.torque == 0.0


def test_heat_derates_before_it_trips():
    """Half-way between 120 and 140 degC half of the torque is left."""
    bench = Bench()
    bench.enable()
    bench.circuit.drive.injected.winding_rise = 90.0  # on 40 degC of coolant
    bench.cycle(ticks=30, **(RUN | {"Torque": 360.0}))
    assert bench.circuit.drive.torque == pytest.approx(180.0, rel=0.02)
    assert bench.received["Drive11_Faults"]["Derating"] == 1.0
    assert bench.state() == OPERATION_ENABLED


def test_winding_heats_by_the_copper_loss():
    """0.045 * 250^2 W into 4000 J/K, the shaft held by the load.

    0.703 K in a second, less 1 % to the coolant.
    """
    bench = Bench()
    hold(bench, 0.0)
    bench.enable()
    bench.cycle(ticks=1000, **(RUN | {"Torque": 250.0}))
    assert bench.circuit.drive.temperatures.winding == pytest.approx(0.703, rel=0.02)


def test_power_from_the_supply_is_shaft_power_and_losses():
    """100 N m at 1000 rpm are 10472 W, with losses of 450 + 104.7 + 11 + 60 + 200 W."""
    bench = Bench()
    hold(bench, 1000.0)
    bench.enable()
    bench.cycle(ticks=3000, **(RUN | {"Torque": 100.0}))
    electrical = bench.received["Drive11_Electrical"]
    assert electrical["DcVoltage"] * electrical["DcCurrent"] == pytest.approx(
        10472.0 + 825.7, rel=5e-3
    )
    assert electrical["PhaseCurrent"] == pytest.approx(125.0, abs=0.2)


def test_another_direction_under_torque_is_a_fault():
    bench = Bench()
    bench.enable()
    bench.cycle(ticks=2, **(RUN | {"Torque": 50.0, "Direction": 1.0}))
    assert bench.circuit.drive.torque == 0.0
    bench.cycle(ticks=12)
    assert bench.received["Drive11_Faults"]["DirectionChanged"] == 1.0


def test_a_machine_under_test_refuses_speed_mode():
    bench = Bench()
    bench.enable()
    bench.cycle(ticks=12, **(SPEED | {"Speed": 100.0, "Controlword": float(ENABLE_COMMAND)}))
    assert bench.received["Drive11_Faults"]["ModeRefused"] == 1.0
    assert bench.circuit.speed == 0.0


def test_a_few_lost_frames_are_a_warning_only():
    bench = Bench()
    bench.enable()
    bench.cycle(ticks=20, **(RUN | {"Torque": 50.0}))
    for _ in range(2):
        bench.frame("Drive11", RUN)  # never sent
        bench.step()
    bench.cycle(**(RUN | {"Torque": 50.0}))
    bench.cycle(ticks=9, **(RUN | {"Torque": 50.0}))
    assert bench.received["Drive11_Faults"]["FramesLost"] == 1.0
    assert bench.state() == OPERATION_ENABLED
    assert bench.circuit.drive.torque > 49.0


def test_a_reset_needs_its_bit_to_rise_without_torque_and_without_enabling():
    bench = Bench()
    bench.enable()
    bench.circuit.drive.injected.trip = 1.0
    bench.cycle(ticks=3)
    assert bench.state() == FAULT
    reset = {"Controlword": float(FAULT_RESET)}
    bench.cycle(ticks=3)
    bench.cycle(ticks=3, **(NOTHING | reset))
    assert bench.state() == FAULT  # the cause is still there
    bench.circuit.drive.injected.trip = 0.0
    bench.cycle(ticks=3, **(NOTHING | reset))
    assert bench.state() == FAULT  # the bit has not risen
    bench.cycle(ticks=3)
    bench.cycle(ticks=3, **(NOTHING | reset | {"Torque": 10.0}))
    assert bench.state() == FAULT
    bench.cycle(ticks=3)
    bench.cycle(ticks=3, **(NOTHING | {"Controlword": float(FAULT_RESET | ENABLE_COMMAND)}))
    assert bench.state() == FAULT
    bench.cycle(ticks=3)
    bench.cycle(ticks=10, **(NOTHING | reset))
    assert bench.state() == SWITCH_ON_DISABLED
    assert bench.received["Drive11_Faults"]["ErrorCode"] == 0.0


@pytest.mark.parametrize(("count", "identifiers"), [(4000, "all"), (4000, "ours")])
def test_random_frames_move_no_motor(count: int, identifiers: str):
    """The long form, 100 000 of each kind: `python benchmarks/can_faults.py --fuzz 100000`."""
    numbers_, bench = random.Random(count), Bench()
    known = [frame.identifier for frame in ours()]
    for _ in range(count):
        identifier = numbers_.getrandbits(11) if identifiers == "all" else numbers_.choice(known)
        bench.station.receive(Frame(identifier, numbers_.randbytes(numbers_.randrange(9))))
        bench.step()
        assert bench.circuit.speed == bench.circuit.drive.torque == bench.circuit.load.torque == 0.0


def test_compiled_code_gives_the_same_bits():
    """Enabling, torque, a lost link, a fault and a reset.

    Every number of the state after every cycle.
    """
    p = CircuitParameters()
    tree, frames = number_tree(p), bench_frames(ours())
    layouts = one_record(frames)[0]
    s, memory, constants = Circuit(), one_record(Circuit())[0], one_record(tree)[0]
    step, receive = compiled(advance_circuit), compiled(receive_set_point)
    frame, counter = ours()["Drive11_SetPoint"], 0
    words = [0] * 5 + [SHUTDOWN] * 5 + [SWITCH_ON_COMMAND] * 800 + [ENABLE_COMMAND] * 50
    words += [-1] * 15 + [0] * 5 + [FAULT_RESET] * 5 + [SHUTDOWN] * 5
    for word in words:
        if word >= 0:
            values = TORQUE | {
                "Controlword": float(word),
                "Torque": 0.0 if word != ENABLE_COMMAND else 77.0,
            }
            payload = protected(frame.payload(values), 8, frame.data_id, counter)
            counter = (counter + 1) % 15
            answer = receive_set_point(frames.set_point, frames.drive_11, s.drive, payload)
            assert (
                receive(layouts["set_point"], layouts["drive_11"], memory["drive"], payload)
                == answer
            )
        advance_circuit(namespace(tree), s, TICK)
        step(constants, memory, TICK)
        assert list(flat(memory)) == numbers(s)
    assert s.drive.state == READY_TO_SWITCH_ON
    assert s.speed > 0.0


def flat(memory) -> list[float]:
    return memory.reshape(1).view(float).tolist()
