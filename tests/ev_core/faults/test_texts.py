"""Texts that declare a fault: their meaning, and those that are refused before a run."""

from __future__ import annotations

import pytest

from ev_core.faults.fault import parsed
from ev_core.faults.row import FAULT_WIDTH, FAULTS_HEAD, PLACE, FaultRow
from ev_core.lockstep.configuration import configure
from ev_core.lockstep.parts import compiled_parts, hand_over, part_of
from ev_msgs_py.contract.frame import Frame, channels, places
from ev_msgs_py.refusal import ParameterError
from ev_stack.scenarios.scenario import Overrides, load_scenario


def test_a_text_in_full():
    (fault,) = parsed(("motor_share left 0.5 from 2 until 3.5",))
    assert (fault.kind, fault.where, fault.value, fault.begin, fault.end) == (
        "motor_share",
        "left",
        0.5,
        2.0,
        3.5,
    )
    assert fault.wheels() == (1.0, 0.0, 1.0, 0.0)
    assert fault.periods(0.01) == (200.0, 350.0)
    assert parsed(("frozen imu from 0.3",))[0].periods(0.01)[0] == 30.0  # 0.3 / 0.01 is 29.999...


REFUSED = {
    "motor_share": "expected KIND WHERE",
    "motr_share all 0": "did you mean motor_share",
    "motor_share all": "lacks its value, 0 to 1",
    "motor_share all 2": "2 is refused, expected 0 to 1",
    "motor_share all nan": "nan is refused",
    "motor_share middle 0": "middle is refused, expected front_left",
    "motor_share rear 0": "needs a motor there, of front_left, front_right",
    "motor_stuck all from 3 until 2": "ends at 2 s",
    "motor_stuck all at 3": "expected KIND WHERE",
    "frozen wheel_stats": "did you mean wheel_states",
    "swapped wheel_states.velocity": "names 4 numbers",
    "tilted pose.x 0.1": "expected accelerations",
    "restarted imu": "is a thing and no program",
    "frozen imu from 0.301 until 0.309": "strikes at no instant",
    "motor_share all 0 from 0.301 until 0.309": "strikes at no instant",
    "hall_stuck all": "needs drive ideal",
    "battery_share all 0": "expected battery",
    "inverter_delay all 0.5001": "0.5001 is refused",
}


@pytest.mark.parametrize("text", REFUSED)
def test_refused_in_one_line(text):
    with pytest.raises(ParameterError) as refusal:
        part = configure(
            "plant", {"method": "planar", "vehicle.driven_wheels": ["front_left", "front_right"]}
        )
        part_of(part.changed({"faults": [text]}), compiled=True)
    assert REFUSED[text] in str(refusal.value) and "\n" not in str(refusal.value)
    assert repr(text) in str(refusal.value)


def test_a_plant_without_faults_of_the_car_says_so():
    with pytest.raises(ParameterError, match="is refused at this plant, expected constant"):
        configure("plant", {"method": "kinematic", "faults": ["motor_share all 0"]})
    with pytest.raises(ParameterError, match="unknown number of this node 'wheel_states'"):
        configure("driver", {"faults": ["frozen wheel_states"]})


def test_faults_may_be_set_while_a_node_runs():
    """A part goes on with its state, the fault begins, and an empty list ends it."""
    there, configuration = Frame(), configure("plant", {"method": "planar", "initial_speed": 10.0})
    plant, seen = part_of(configuration, compiled=True), []
    plant.start(there)
    for texts in ((), ("constant imu.yaw_rate 0.5",), ()):
        after = part_of(configuration.changed({"faults": texts}), compiled=True)
        hand_over(plant, after)
        plant = after
        plant.step(Frame(), there)
        seen.append(there.numbers[channels()["imu.yaw_rate"]])
    assert seen == [0.0, 0.5, 0.0]
    # three periods of 10 m/s
    assert there.numbers[channels()["pose.x"]] == pytest.approx(0.3, rel=0.01)


def test_a_fault_as_short_as_a_period_strikes_once():
    """Refused is only what lies between two instants; 0.3 / 0.01 is 29.999..."""
    texts = (
        "frozen imu from 0.3 until 0.301",
        "frozen imu from 0.295 until 0.305",
        "frozen imu from 0.3 until 0.31",
    )
    assert [fault.periods(0.01) for fault in parsed(texts)] == [(30.0, 31.0)] * 3
    configure("plant", {"faults": texts})


def test_a_restarted_node_sends_nothing_at_all():
    """A node that is killed cannot go on with some of its numbers, nor with another topic."""
    part = "restarted torque_command.drive.front_left"
    message = "unknown topic of this node 'torque_command.drive.front_left'"
    with pytest.raises(ParameterError, match=message):
        configure("asr", {"faults": [part]})
    asr = configure(
        "asr", {"method": "speed_corridor", "faults": ["restarted torque_command until 1"]}
    )
    row = FaultRow(parsed(asr.faults), asr.method.writes, 0, 0.01)
    assert len(asr.method.writes) == 2
    struck = {
        int(row.constants[n + PLACE]) for n in range(FAULTS_HEAD, len(row.constants), FAULT_WIDTH)
    }
    assert struck == {place for signal in asr.method.writes for place in places(signal)}


def test_what_goes_on_goes_on_though_another_fault_comes_or_goes():
    """The wheel speed was frozen at the start, and stays what it was; the new fault begins now."""
    configuration, there = configure("plant", {"method": "planar", "initial_speed": 10.0}), Frame()
    speed, x = channels()["wheel_states.velocity.rear_left"], channels()["pose.x"]
    lists = (
        ["frozen pose.x"],
        ["delayed twist 0.02", "frozen pose.x"],
        ["frozen pose.x", "frozen wheel_states"],
    )
    plant, seen = None, []
    for texts in lists:
        after = part_of(configuration.changed({"faults": texts}), compiled=True)
        if plant is None:
            after.start(there)
        else:
            hand_over(plant, after)
        plant = after
        plant.step(Frame(), there)
        seen.append((there.numbers[x], there.numbers[speed]))
    assert [at for at, _ in seen] == [0.0] * 3
    assert all(turning > 20.0 for _, turning in seen)  # 10 m/s, and no zeros of an empty memory


@pytest.mark.parametrize(("begin", "notes"), [("0.5", 0), ("0.51", 1)])
def test_a_fault_that_begins_after_the_end_is_noted(begin, notes):
    values = [("plant", "faults", [f"frozen imu from {begin}"])]
    found = load_scenario(
        "step_steer", Overrides(values=values, duration=0.5), only=("left",)
    ).notes
    assert [
        f"'frozen imu from {begin}' begins after the end at 0.5 s" in note for note in found
    ] == [True] * notes


def test_what_is_not_asked_for_is_not_there():
    assert len(compiled_parts(configure("asr", {}))) == 1
    assert len(compiled_parts(configure("asr", {"faults": ["lost torque_command 0.1"]}))) == 2
    assert (
        len(compiled_parts(configure("asr", {"faults": ["restarted torque_command until 1"]}))) == 3
    )
