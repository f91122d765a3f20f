"""The Gymnasium environments.

The checker's rules, the plain run's bits, and what a random agent gets.
"""

from __future__ import annotations

import copy
import math
import pickle
import runpy
import subprocess
import sys
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import ev_doors.learning
import ev_stack
from ev_core.methods.register import methods_of
from ev_core.parameters.data_file import files_in_config
from ev_core.vehicle.description import Vehicle
from ev_doors.learning.environment import ACTIONS, Environment
from ev_doors.learning.limits import limits
from ev_doors.learning.rewards import calm_yaw
from ev_doors.learning.view import picture
from ev_msgs_py.contract import frame
from ev_msgs_py.contract.fields import shape_of
from ev_msgs_py.contract.optional_signals import RearSteeringState
from ev_msgs_py.contract.signals import (
    BodyVelocity,
    InertialMeasurement,
    SteeringColumnState,
    TireForces,
)
from ev_msgs_py.refusal import ParameterError
from ev_stack.interface.simulation import Simulation
from ev_stack.recording.offline import written_topics
from ev_stack.recording.recording import signal_hash
from ev_stack.scenarios.files import vehicle_of
from ev_study.commands.benchmark import run_benchmark

EXAMPLE = Path(__file__).parents[3] / "docs" / "examples" / "random_agent.py"
BRAKES_BY_DRIVES = ("blended_brakes",)
NOISE = {"plant.sensors.imu_yaw_rate.noise": 0.01}
DURATION = 0.4


@pytest.mark.parametrize("name", ev_doors.learning.IDS)
@pytest.mark.filterwarnings("ignore:.*(Box action space|no `spec`)")
def test_environments_keep_the_rules_of_gymnasium(name):
    """Bounds in N m are not -1 to 1, but those of motors and hands.

    That is all that the checker remarks.
    """
    check_env(gymnasium.make(name, duration=DURATION, render_mode="rgb_array").unwrapped)


@pytest.mark.parametrize(
    ("scenario", "run"),
    [("double_lane_change", ""), ("launch_split_mu", "fixed_steering"), ("shchur2019", "")],
)
def test_everything_that_a_car_shows_lies_within_its_limits(scenario, run):
    """Nothing is cut off on the planar and the kinematic plant."""
    everything = [
        topic.name.replace("/", ".")
        for topic in written_topics(Simulation(scenario, run=run).configurations)
    ]
    driven = {"set": {"plant.initial_speed": 22.0}} if scenario == "double_lane_change" else {}
    environment = Environment(scenario, observe=everything, run=run, duration=2.0, **driven)
    assert (
        {*environment.observed}
        == {*environment.limits}
        >= {"pose.x", "torque_request.brake.rear_left"}
    )
    assert np.isfinite(environment.observation_space.high).all()
    _, info = environment.reset(seed=1)
    over = False
    while not over:
        seen, _, _, over, info = environment.step(info["own"])
        assert seen.tolist() == [info["frame"][name] for name in environment.observed]


@pytest.mark.parametrize("car", sorted(files_in_config("vehicles")))
def test_every_channel_of_every_car_has_a_limit(car):
    vehicle = vehicle_of(car)
    found = limits(
        tuple(frame.channels()), vehicle, 10.0, start={}, motor_torque=vehicle.motor.peak_torque
    )
    assert all(0.0 < limit.largest < math.inf and limit.reason for limit in found.values())


@pytest.mark.sampled
@pytest.mark.parametrize("car", sorted(files_in_config("vehicles")))
def test_the_bounds_of_torques_are_those_that_the_plant_lets_a_wheel_have(car):
    """A torque beyond the upper bound is cut to it by the guard, and one at the bound is not.

    Axles may differ.
    """
    scenario, law = "step_steer", {"electronic_differential": "equal_torque"}
    environment = Environment(scenario, run="left", vehicle=car, method=law, duration=1.0)
    plant = environment.simulation.configurations["plant"]
    guard = plant.method.law.prepare(plant.parameters, plant.common.vehicle, 0.01)
    wheels = [channel.rpartition(".")[2] for channel in environment.channels]
    most = [getattr(guard.limits.drive, wheel) for wheel in wheels]
    assert environment.action_space.high.tolist() == most
    assert (environment.action_space.low <= 0.0).all()
    limited = Environment(
        scenario, "traction_control", run="left", vehicle=car, method=law, duration=1.0
    )
    assert (limited.action_space.high >= environment.action_space.high).all()
    assert limited.action_space.low.tolist() == [0.0] * len(wheels)


def test_the_bounds_on_the_kinematic_plant_are_those_of_its_drives():
    """Its largest torque is a parameter of the plant, and not of the car."""
    environment = Environment("shchur2019", set={"plant.motor.torque_limit": 40.0})
    gear = environment.simulation.configurations["plant"].common.vehicle.gear_ratio
    assert environment.action_space.high.tolist() == [40.0 * gear] * 2
    assert environment.action_space.low.tolist() == [-40.0 * gear] * 2


def test_what_lies_beyond_a_limit_is_observed_as_the_limit():
    """A broken sensor shows 1000 rad/s; it saturates at 10 rad/s, faster than any car turns."""
    broken = {"plant.faults": ["constant imu.yaw_rate -1000"]}
    environment = Environment("double_lane_change", observe=("imu.yaw_rate",), set=broken)
    environment.reset(seed=1)
    seen, *_, info = environment.step(np.zeros(2))
    assert info["frame"]["imu.yaw_rate"] == -1000.0 and seen.tolist() == [-10.0]
    assert seen in environment.observation_space


def _rear_wheels(car: Vehicle, here: dict[str, float]) -> np.ndarray:
    """Places of the black pixels behind the centre of mass, in a picture of a car that heads right."""
    pixels = picture(car, here, 0.0, [])
    # Away from letters and axes.
    black = np.argwhere((pixels[150:330, 150:330] < 40).all(axis=2))
    return black[black[:, 1] < np.mean(black[:, 1])]


@pytest.mark.parametrize(
    ("ratio", "angle"), [(-0.5, 0.0), (0.0, -0.2)], ids=["ratio", "rear steering"]
)
def test_a_picture_turns_the_rear_wheels(ratio, angle):
    """A share of the front angle turns them, and the angle of a law does alike."""
    car = vehicle_of("compact_ev")
    here = {
        "pose.x": 0.0,
        "pose.y": 0.0,
        "pose.orientation_z": 0.0,
        "pose.orientation_w": 1.0,
        "twist.longitudinal": 0.0,
        "twist.lateral": 0.0,
        "steering_column.state.road_wheel_angle": 0.4,
    }
    straight = _rear_wheels(car, here)
    steered = replace(car, rear_steering_ratio=ratio)
    turned = _rear_wheels(steered, {**here, "rear_steering.state.angle": angle})
    # A turned wheel is longer across the picture.
    assert len(np.unique(turned[:, 0])) > len(np.unique(straight[:, 0])) + 2


def test_a_neutral_car_turns_by_the_angle_between_its_axles():
    """Rear wheels that turn along with the front ones leave nothing to turn by: V (d_f - d_r)/L."""

    def reward(rear_ratio: float = 0.0, rear_angle: float = 0.0) -> float:
        car = SimpleNamespace(wheelbase=2.5, steering_ratio=16.0, rear_steering_ratio=rear_ratio)
        column = SteeringColumnState(1.6, 0.0, 0.0, 0.0, 0.0)
        no_slip = shape_of(TireForces).signal_of([0.0] * shape_of(TireForces).size)
        moving = BodyVelocity(10.0, 0.0, 0.0), column, InertialMeasurement(0.0, 0.0, 0.0)
        return calm_yaw(car, *moving, RearSteeringState(rear_angle, 0.0, 0.0, 0.0, 0.0), no_slip)

    assert reward(rear_angle=0.1) == reward(rear_ratio=1.0) == 0.0
    # 10 m/s times 10/2.5 0.1 rad/s, squared.
    assert reward() == pytest.approx(-16.0)


def test_a_picture_shows_the_car_where_it_is():
    """The body is grey, and longer than it is wide.

    Along the picture, and up where it has turned by 90 deg.
    """
    for heading, along in ((0.0, 1), (math.pi / 2.0, 0)):
        still = {"plant.initial_heading": heading}
        environment = Environment("double_lane_change", render_mode="rgb_array", set=still)
        environment.reset(seed=1)
        pixels = environment.render()
        body = np.argwhere((pixels[120:360, 120:360] == 211).all(axis=2))  # away from the letters
        extent = np.ptp(body, axis=0)
        assert pixels.shape == (480, 480, 3) and pixels.dtype == np.uint8
        assert extent[along] > 1.5 * extent[1 - along] > 0
    assert environment.metadata["render_fps"] == pytest.approx(1e9 / environment.simulation.period)
    assert Environment("double_lane_change").render() is None


@pytest.mark.parametrize(
    ("action", "role", "method"),
    [
        ("torque_split", "electronic_differential", "power_steering"),
        ("traction_control", "asr", "pi_slip"),
        ("steering", "driver", None),
    ],
)
def test_actions_of_the_law_give_the_bits_of_the_plain_run(action, role, method):
    changed = {
        "set": NOISE,
        "duration": DURATION,
        "method": {role: method} if method else {},
        "seed": 3,
    }
    environment = Environment(
        "double_lane_change", action, record=True, **{**changed, "seed": None}
    )
    _, info = environment.reset(seed=3)
    over = False
    while not over:
        _, _, _, over, info = environment.step(info["own"])
    plain = ev_stack.run("double_lane_change", **changed)
    assert signal_hash(environment.simulation.recording) == signal_hash(
        next(iter(plain.runs.values()))
    )


def test_the_seed_of_an_environment_is_that_of_its_first_episode():
    """It acts as `reset(seed=3)`; later episodes are drawn from it, alike in two environments."""

    def episodes(given: int | None, first: int | None) -> list[list[float]]:
        environment = Environment("double_lane_change", seed=given, set=NOISE, duration=DURATION)
        found = []
        for seed in (first, None):
            environment.reset(seed=seed)
            found.append(environment.step(np.zeros(2))[0].tolist())
        return found

    given = episodes(3, None)
    assert given == episodes(3, None) == episodes(None, 3)
    assert given[0] != given[1]
    assert given == episodes(4, 3)  # the seed of a reset comes first


@pytest.mark.parametrize(
    "method", [name for name, each in methods_of("asr").items() if not each.requires]
)
def test_actions_of_any_traction_control_give_the_bits_of_the_plain_run_or_one_line(method):
    """Split friction, braked and steered: same bits, or one line for laws that brake by drives."""
    changed = {"duration": 1.5, "method": {"asr": method}, "vehicle": "audi_a2"}
    environment = Environment(
        "straight_brake_split_mu", "traction_control", run="steered", record=True, **changed
    )
    over = False
    try:
        _, info = environment.reset(seed=1)
        while not over:
            _, _, _, over, info = environment.step(info["own"])
    except ParameterError as error:
        assert method in BRAKES_BY_DRIVES
        assert f"asr method {method} writes torque_command.drive." in str(error)
        return
    assert method not in BRAKES_BY_DRIVES
    plain = ev_stack.run("straight_brake_split_mu", runs=["steered"], seed=1, **changed)
    assert signal_hash(environment.simulation.recording) == signal_hash(plain.runs["steered"])


def test_a_step_before_the_first_reset_is_refused():
    environment = Environment(duration=DURATION)
    with pytest.raises(
        ParameterError,
        match=r"^step is refused before the first reset, expected is reset\(\) before",
    ):
        environment.step(np.zeros(2))


def test_an_option_of_reset_is_refused():
    environment = Environment("double_lane_change")
    environment.reset(options={})
    with pytest.raises(
        ParameterError, match=r"^reset option 'plant\.initial_speed' is refused, expected is none"
    ):
        environment.reset(options={"plant.initial_speed": 10.0})


def test_what_is_observed_rewarded_and_ended_is_the_users():
    environment = Environment(
        "double_lane_change",
        observe=("imu", "twist.longitudinal"),
        reward=lambda frame, action, own: frame["twist.longitudinal"] + action[0],
        ends=lambda frame: frame["pose.x"] > 0.5,
        set=NOISE,
    )
    first, _ = environment.reset(seed=1)
    seen, reward, ended, over, info = environment.step(np.array([7.0, 0.0]))
    assert environment.observed[-1] == "twist.longitudinal"
    assert seen.tolist() == [info["frame"][name] for name in environment.observed]
    assert reward == seen[-1] + 7.0
    assert (ended, over) == (info["frame"]["pose.x"] > 0.5, False)
    again, _ = environment.reset(seed=1)
    other, _ = environment.reset()
    assert first.tolist() == again.tolist() != other.tolist()


@pytest.mark.parametrize(
    "copied", [copy.deepcopy, lambda one: pickle.loads(pickle.dumps(one))], ids=["copy", "pickle"]
)
@pytest.mark.parametrize("action", ACTIONS)
def test_a_copy_goes_on_with_the_same_bits_and_by_itself(action, copied):
    environment = Environment("double_lane_change", action, set=NOISE)
    _, info = environment.reset(seed=2)
    for _ in range(3):
        info = environment.step(info["own"])[4]
    other = copied(environment)
    seen, reward, *_ = environment.step(info["own"])
    seen_by_other, reward_of_other, *_ = other.step(info["own"])
    assert (seen.tolist(), reward) == (seen_by_other.tolist(), reward_of_other)
    assert environment.reset()[0].tolist() == other.reset()[0].tolist()  # the next seed, too


@pytest.mark.parametrize("action", [1.0, [1.0], [1.0, 2.0, 3.0], [[1.0, 2.0]]])
def test_an_action_of_another_shape_is_refused_and_nothing_is_done(action):
    environment = Environment("double_lane_change")
    environment.reset(seed=1)
    with pytest.raises(ParameterError) as error:
        environment.step(np.array(action))
    channels = "torque_request.drive.front_left, torque_request.drive.front_right"
    assert (
        str(error.value)
        == f"action of shape {np.shape(action)} is refused, expected (2,), of {channels}"
    )
    assert environment.simulation.time == 0.0


@pytest.mark.parametrize("kind", ["torque_split", "traction_control", "steering"])
@pytest.mark.parametrize("wrong", [np.nan, np.inf, -np.inf, None, "3", 1j], ids=str)
def test_an_action_that_is_no_finite_number_is_refused_and_nothing_is_done(kind, wrong):
    """It is neither taken as no limit, as NaN in comparisons, nor found behind the step."""
    environment = Environment("double_lane_change", kind)
    environment.reset(seed=1)
    action = np.full(environment.action_space.shape, 1.0).astype(
        object if wrong is None else type(wrong)
    )
    action[-1] = wrong
    with pytest.raises(
        ParameterError, match=r"^action .* is refused, expected are finite numbers$"
    ):
        environment.step(action)
    assert environment.simulation.time == 0.0


def test_a_limit_below_zero_lets_nothing_through():
    """It does not drive the car: what is asked for is held at 0, as with the limit 0."""
    found = []
    for limit in (0.0, -100.0):
        environment = Environment("launch_split_mu", "traction_control", run="fixed_steering")
        environment.reset(seed=1)
        for _ in range(100):
            frame = environment.step(np.array([limit, limit]))[4]["frame"]
        found.append(frame)
    assert found[0]["torque_request.drive.front_left"] > 300.0
    assert found[0]["torque_command.drive.front_left"] == 0.0
    assert found[1] == found[0]


def test_what_an_action_means():
    """Traction control lets through what is asked for up to its limit, either way."""
    environment = Environment("launch_split_mu", "traction_control", run="fixed_steering")
    environment.reset(seed=1)
    for _ in range(100):
        environment.step(np.array([200.0, 1e4]))
    frame = environment.step(np.array([200.0, 1e4]))[4]["frame"]
    left, right = (frame[f"torque_request.drive.front_{side}"] for side in ("left", "right"))
    assert left > 300.0
    shown = [frame[f"wheel_states.effort.front_{side}"] for side in ("left", "right")]
    assert shown == pytest.approx([200.0, right], rel=0.05)  # the motors lag by some milliseconds


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (
            {"action": "brakes"},
            "unknown action 'brakes'; known: steering, torque_split, traction_control",
        ),
        ({"render_mode": "human"}, "unknown render_mode 'human'; known: rgb_array"),
        ({"observe": ("imu.yaw",)}, "unknown channel 'imu.yaw'; did you mean imu.yaw_rate"),
    ],
)
def test_wrong_words_get_one_line(arguments, message):
    with pytest.raises(ParameterError) as error:
        Environment(**arguments)
    assert str(error.value).startswith(message)


def test_without_gymnasium_one_line_says_how_to_get_it(monkeypatch):
    monkeypatch.setitem(sys.modules, "gymnasium", None)
    monkeypatch.delitem(sys.modules, "ev_doors.learning")
    with pytest.raises(
        ImportError, match=r"^gymnasium cannot be imported .*: pip install 'ev_doors\[gymnasium\]'$"
    ):
        __import__("ev_doors.learning")


def test_the_example_runs(capsys):
    for _ in range(2):
        runpy.run_path(str(EXAMPLE))
        lines = capsys.readouterr().out.splitlines()
        assert [line.partition(",")[0] for line in lines] == ["seed 1: 2.01 s", "seed 2: 2.01 s"]


def test_a_policy_is_learned_here_and_driven_on_the_board(tmp_path: Path):
    """One generation of short episodes; the law with its weights keeps the contract, and is ranked.

    It is trained in a process of its own, as a user does: what imports policy.py has its law in the
    register from then.
    """
    weights, folder = tmp_path / "weights.yaml", EXAMPLE.parent / "learned"
    words = [
        sys.executable,
        str(folder / "train.py"),
        str(weights),
        *("--generations", "1", "--duration", "0.1", "--draws", "1", "--candidates", "4"),
        *("--cells", "*:sine_with_dwell:wet:*", "--figure", str(tmp_path / "curve.png")),
    ]
    learned = []
    for _ in range(2):  # seeded: again the same policy, in the place of the first one
        output = subprocess.run(words, check=True, capture_output=True, text=True).stdout
        assert "generation 1: equal torques " in output and "held out, 10 runs: loss " in output
        learned.append(weights.read_text())
    assert learned[0] == learned[1]
    assert (tmp_path / "curve.png").stat().st_size > 1000
    words = [
        "--laws",
        "equal_torque",
        "--cells",
        "layout_1_8_c:all:step_steer:wet:*",
        "--draws",
        "1",
        "--no-report",
    ]
    for out in (tmp_path / "first", tmp_path / "second"):
        run_benchmark(["--add", f"{folder / 'policy.py'}={weights}", *words, "--out", str(out)])
        assert "## weights" in (out / "laws.md").read_text()


AS_THE_LAW = """
from train import *
from ev_core.lockstep.configuration import configure
from ev_core.parameters.declaration import flatten

board = replace(with_cases(read_board("small"), "training", 1), draws=3)
(cell,) = board.cells("compact_ev:front:double_lane_change:wet:*")
course, weights = Course(board, cell, 1, 1.0), np.random.default_rng(1).normal(size=WEIGHTS)
common = flatten(course.run.configurations[ROLE].common)
law = configure(ROLE, {**common, "method": POLICY_FILE, "weights": weights.tolist()})
run = replace(course.run, configurations={**course.run.configurations, ROLE: law})
vector = course.vector_of(run)
seen, info = vector.reset(seed=1)
for _ in range(30):
    chosen = course.actions(np.tile(weights, (3, 1)).T, seen)
    assert chosen.tobytes() == info["own"].tobytes()
    seen, *_, info = vector.step(chosen)
"""


@pytest.mark.weekly
def test_the_policy_that_is_trained_has_the_bits_of_the_law():
    """Arrays of the trainer beside the law as it drives, with a draw of the board for each car."""
    folder = EXAMPLE.parent / "learned"
    code = AS_THE_LAW.replace("POLICY_FILE", repr(str(folder / "policy.py")))
    subprocess.run([sys.executable, "-c", code], check=True, cwd=folder)
