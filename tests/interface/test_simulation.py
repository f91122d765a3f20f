"""ev_sim.Simulation: a loop of one's own around the car gives what the same law gives inside."""

from __future__ import annotations

import copy
import pickle

import pytest

import ev_sim
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_msgs_py.parameters.declaration import ParameterError
from ev_sim.running.recording.recording import signal_hash

NOISE = {"plant.sensors.imu_yaw_rate.noise": 0.01}
STEPS = 60


def simulation(**more) -> ev_sim.Simulation:
    return ev_sim.Simulation("double_lane_change", set={**NOISE, "plant.initial_speed": 15.0}, **more)


def equal_torques(frame) -> dict[str, float]:
    """What `equal_torque` writes for a car with two driven front wheels."""
    torques = {
        f"torque_request.drive.front_{side}": frame["driver.command.drive_torque"] / 2 for side in ("left", "right")
    }
    brakes = {f"torque_request.brake.{wheel}": frame["driver.command.brake_torque"] / 4 for wheel in WHEEL_NAMES}
    return {**torques, **brakes}


@pytest.fixture(scope="module")
def inside():
    changed = {**NOISE, "plant.initial_speed": 15.0}
    chosen = {"electronic_differential": "equal_torque"}
    return ev_sim.run("double_lane_change", method=chosen, set=changed, duration=(STEPS - 1) * 0.01)


def test_ones_own_torque_split_gives_the_bits_of_the_built_in_one(inside):
    outside = simulation(without=("electronic_differential",))
    frame = outside.frame
    for _ in range(STEPS):
        frame = outside.step(equal_torques(frame))
    assert signal_hash(outside.recording) == signal_hash(next(iter(inside.runs.values())))
    assert outside.time == pytest.approx(STEPS * 0.01)


def test_ones_own_driver_and_column_are_told_what_they_do(inside):
    """Also a role that integrates can be left out: what it writes at an instant is given at that instant."""
    signals = inside.signals
    outside = simulation(without=("driver", "steering_column"), method={"electronic_differential": "equal_torque"})
    assert set(outside.inputs) <= set(signals)
    for n in range(STEPS):
        outside.step({name: float(signals[name][n]) for name in outside.inputs})
    assert signal_hash(outside.recording) == signal_hash(next(iter(inside.runs.values())))


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


@pytest.mark.parametrize("copied", [copy.deepcopy, lambda car: pickle.loads(pickle.dumps(car))], ids=["copy", "pickle"])
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


def test_reset_begins_anew():
    car = simulation()
    start = car.frame
    first = [car.step() for _ in range(5)]
    assert car.reset() == start
    assert [car.step() for _ in range(5)] == first
    assert len(car.recording.time) == 5


@pytest.mark.parametrize(
    ("inputs", "said"),
    [
        ({"torque_request.drive.left": 1.0}, "unknown input 'torque_request.drive.left'; known: torque_request.drive."),
        ({"imu.yaw_rate": 1.0}, "unknown input 'imu.yaw_rate'; known: "),
        ({"torque_request.drive.front_left": float("nan")}, "input torque_request.drive.front_left: nan is refused"),
    ],
)
def test_other_inputs_are_refused_and_nothing_is_done(inputs, said):
    car = simulation(without=("electronic_differential",))
    before = car.frame
    with pytest.raises(ParameterError) as error:
        car.step({"torque_request.brake.rear_left": 1.0, **inputs})
    assert str(error.value).startswith(said)
    assert car.frame == before


def test_an_unknown_role_is_refused():
    with pytest.raises(ParameterError, match=r"^unknown role 'brakes'; known: "):
        simulation(without=("brakes",))
