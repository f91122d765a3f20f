"""ev_stack.Simulation: a loop of one's own around the car gives what the same law gives inside."""

from __future__ import annotations

import copy
import pickle
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import ev_stack
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_msgs_py.refusal import ParameterError
from ev_stack.interface.driving import only_run, overrides
from ev_stack.recording.recording import signal_hash

NOISE = {"plant.sensors.imu_yaw_rate.noise": 0.01}
STEPS = 60


def simulation(**more) -> ev_stack.Simulation:
    return ev_stack.Simulation(
        "double_lane_change", set={**NOISE, "plant.initial_speed": 15.0}, **more
    )


def equal_torques(frame) -> dict[str, float]:
    """Signals that `equal_torque` writes for a car with two driven front wheels."""
    torques = {
        f"torque_request.drive.front_{side}": frame["driver.command.drive_torque"] / 2
        for side in ("left", "right")
    }
    brakes = {
        f"torque_request.brake.{wheel}": frame["driver.command.brake_torque"] / 4
        for wheel in WHEEL_NAMES
    }
    return {**torques, **brakes}


@pytest.fixture(scope="module")
def inside():
    changed = {**NOISE, "plant.initial_speed": 15.0}
    chosen = {"electronic_differential": "equal_torque"}
    return ev_stack.run(
        "double_lane_change", method=chosen, set=changed, duration=(STEPS - 1) * 0.01
    )


def test_ones_own_torque_split_gives_the_bits_of_the_built_in_one(inside):
    outside = simulation(without=("electronic_differential",))
    frame = outside.frame
    for _ in range(STEPS):
        frame = outside.step(equal_torques(frame))
    assert signal_hash(outside.recording) == signal_hash(next(iter(inside.runs.values())))
    assert outside.time == pytest.approx(STEPS * 0.01)


def test_a_fault_of_the_plant_strikes_at_the_instants_of_a_run():
    """The plant writes the next instant, and so does the fault behind it.

    One period late is another signal.
    """
    changed = {
        **NOISE,
        "plant.initial_speed": 15.0,
        "plant.faults": ["constant imu.yaw_rate 0.5 from 0.1 until 0.2"],
    }
    car = ev_stack.Simulation("double_lane_change", set=changed)
    for _ in range(30):
        car.step()
    run = ev_stack.run("double_lane_change", set=changed, duration=0.29)
    assert signal_hash(car.recording) == signal_hash(next(iter(run.runs.values())))


def test_ones_own_driver_and_column_are_inputs(inside):
    """Also a role that integrates can be left out.

    What it writes at an instant is given at that instant.
    """
    signals = inside.signals
    outside = simulation(
        without=("driver", "steering_column"), method={"electronic_differential": "equal_torque"}
    )
    assert set(outside.inputs) <= set(signals)
    for n in range(STEPS):
        outside.step({name: float(signals[name][n]) for name in outside.inputs})
    assert signal_hash(outside.recording) == signal_hash(next(iter(inside.runs.values())))


def test_ones_own_traction_control_sets_the_speeds_of_drives_in_speed_mode():
    """All signals of a law that is left out can be given: torques, and here speeds as well."""
    outside = ev_stack.Simulation(
        "double_lane_change",
        without=("asr",),
        method={"asr": "speed_by_slip"},
        set={"plant.initial_speed": 1.0},
    )
    speeds = [name for name in outside.inputs if name.startswith("speed_command.")]
    assert len(speeds) == 4
    inputs = dict.fromkeys(speeds, 5.0) | {
        f"torque_command.drive.front_{side}": 800.0 for side in ("left", "right")
    }
    for _ in range(200):
        frame = outside.step(inputs)
    assert frame["wheel_states.velocity.front_left"] == pytest.approx(5.0, rel=0.2)
    assert "speed_command.speed.front_left" in outside.recording.channels


def test_a_state_that_was_kept_is_gone_on_from_with_the_same_bits():
    """Noise of the sensors as well; through a file, and in another simulation."""
    first, second = simulation(record=False), simulation(record=False)
    for _ in range(20):
        first.step()
    kept = pickle.dumps(first.state)
    expected = [first.step() for _ in range(20)]
    second.state = pickle.loads(kept)
    assert [second.step() for _ in range(20)] == expected
    first.state = pickle.loads(kept)
    assert [first.step() for _ in range(20)] == expected


PLANAR = {
    "double_lane_change": "",
    "step_steer": "left",
    "launch_split_mu": "steered",
    "coast_down": "",
}
OF_PLANT = (
    "lost wheel_states 0.4",
    "frozen imu.yaw_rate from 0.03",
    "delayed imu 0.04",
    "reordered wheel_states 0.5",
    "noisy imu 0.1",
    "swapped wheel_states.velocity.front_left,wheel_states.velocity.front_right",
    "motor_stuck front_right from 0.05",
    "inverter_delay front 0.03",
    "puncture rear_left 1 from 0.02",
)
OF_LAW = (
    "lost torque_request 0.4",
    "restarted torque_request from 0.04 until 0.12",
    "delayed torque_request 0.02",
)


@settings(max_examples=10)
@given(
    scenario=st.sampled_from([*PLANAR, "shchur2019", "bench_fault"]),
    seed=st.integers(0, 2**31 - 1),
    of_plant=st.sets(st.sampled_from(OF_PLANT), max_size=3),
    of_law=st.sets(st.sampled_from(OF_LAW), max_size=2),
    without=st.sampled_from([(), ("asr",), ("driver",), ("electronic_differential", "asr")]),
    noise=st.sampled_from([0.0, 0.02]),
    delay=st.integers(0, 3),
    steps=st.integers(0, 15),
)
def test_any_configuration_goes_on_from_any_instant_with_the_same_bits(
    scenario, seed, of_plant, of_law, without, noise, delay, steps
):
    """A fresh simulation with another seed goes on, also through a file.

    Sensors and faults of every kind take part.
    """
    plant = sorted(of_plant) if scenario in PLANAR else []
    changed = {
        "plant.faults": plant,
        "electronic_differential.faults": sorted(of_law),
        "plant.sensors.wheel_speed.noise": noise,
        "plant.sensors.wheel_speed.delay": delay,
    }
    first, second = (
        ev_stack.Simulation(scenario, without, PLANAR.get(scenario, ""), record=False, set=changed)
        for _ in range(2)
    )
    first.reset(seed)
    for _ in range(steps):
        first.step()
    kept = pickle.dumps(first.state)
    expected = [first.step() for _ in range(10)]
    second.step()
    second.state = pickle.loads(kept)
    assert [second.step() for _ in range(10)] == expected


@pytest.mark.parametrize(
    ("other", "message"),
    [
        (
            {"method": {"electronic_differential": "equal_torque"}},
            "state: electronic_differential.method was 'equal_torque', here it is 'power_steering'; expected the",
        ),
        ({"without": ("asr",)}, "state: roles was "),
        (
            {"set": {**NOISE, "*.control_period": 0.02}},
            "state: control period [ns] was 20000000, here it is 10000000",
        ),
        (
            {"set": {**NOISE, "plant.faults": ["lost imu 0.5"]}},
            "state: plant.faults of signals was ['lost imu 0.5']",
        ),
        (
            {"set": {"plant.sensors.imu_yaw_rate.delay": 2}},
            "state: delays of sensors of plant was {'imu_yaw_rate': 2}",
        ),
    ],
)
def test_a_state_that_does_not_fit_is_refused_and_nothing_changes(other, message):
    """One line says what differs, and no half of the state is taken over."""
    method = {"electronic_differential": "power_steering"}
    car, same = (
        ev_stack.Simulation("double_lane_change", method=method, set=NOISE, record=False)
        for _ in range(2)
    )
    saved = ev_stack.Simulation(
        "double_lane_change", **{"method": method, "set": NOISE, "record": False, **other}
    ).state
    with pytest.raises(ParameterError) as error:
        car.state = saved
    assert str(error.value).startswith(message) and "\n" not in str(error.value)
    assert [car.step() for _ in range(5)] == [same.step() for _ in range(5)]


def test_a_state_of_other_sizes_or_of_something_else_is_refused():
    car = simulation(record=False)
    saved = car.state
    short = {
        **saved.parts,
        "asr": tuple(np.zeros(np.size(each) + 1) for each in saved.parts["asr"]),
    }
    with pytest.raises(
        ParameterError, match=r"^state: asr had \d+ numbers, here it has \d+; expected as many"
    ):
        car.state = replace(saved, parts=short)
    older = {**saved.of, "numbers": 7}
    with pytest.raises(ParameterError, match="state: numbers was 7, here it is"):
        car.state = replace(saved, of=older, frame=np.zeros(7))
    with pytest.raises(ParameterError, match="expected the state of a Simulation"):
        car.state = {"instant": 3}


@pytest.mark.parametrize(
    "copied", [copy.deepcopy, lambda car: pickle.loads(pickle.dumps(car))], ids=["copy", "pickle"]
)
def test_a_copy_goes_on_with_the_same_bits_and_by_itself(copied):
    """Its noise and its recording as well; a part is compiled code, which no copy takes along."""
    car = simulation()
    for _ in range(5):
        car.step()
    other = copied(car)
    expected = [car.step() for _ in range(5)]
    assert [other.step() for _ in range(5)] == expected
    assert signal_hash(other.recording) == signal_hash(car.recording)
    assert other.reset() == car.reset()


def test_reset_restarts_the_simulation():
    car = simulation()
    start = car.frame
    first = [car.step() for _ in range(5)]
    assert car.reset() == start
    assert [car.step() for _ in range(5)] == first
    assert len(car.recording.time) == 5


@pytest.mark.parametrize(
    ("inputs", "message"),
    [
        (
            {"torque_request.drive.left": 1.0},
            "unknown input 'torque_request.drive.left'; did you mean torque_request.drive.",
        ),
        ({"imu.yaw_rate": 1.0}, "unknown input 'imu.yaw_rate'; known: "),
        (
            {"torque_request.drive.front_left": float("nan")},
            "inputs['torque_request.drive.front_left']: nan is refused",
        ),
    ],
)
def test_other_inputs_are_refused_and_nothing_is_done(inputs, message):
    car = simulation(without=("electronic_differential",))
    before = car.frame
    with pytest.raises(ParameterError) as error:
        car.step({"torque_request.brake.rear_left": 1.0, **inputs})
    assert str(error.value).startswith(message)
    assert car.frame == before


@pytest.mark.parametrize("changed", [{"seed": 2}, {"run": "object"}])
def test_a_configured_run_is_driven_as_it_is(changed):
    """Differences belong to its configuration; later ones are refused."""
    run = only_run("shchur2019_steps", "object", overrides(duration=0.1))
    assert ev_stack.Simulation(run).duration == 0.1
    with pytest.raises(
        ParameterError, match=r"^run object is configured already, expected a name or path with"
    ):
        ev_stack.Simulation(run, **changed)


def test_an_unknown_role_is_refused():
    with pytest.raises(ParameterError, match=r"^unknown role 'brakes'; known: "):
        simulation(without=("brakes",))
