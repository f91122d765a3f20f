"""Many cars in one call: the bits of single environments behind Gymnasium's own vector of them."""

from __future__ import annotations

import copy
from pathlib import Path

import gymnasium
import numpy as np
import pytest
from gymnasium.vector import AutoresetMode, SyncVectorEnv

import ev_doors.learning
import ev_doors.learning.cars
from ev_core.law import BodyVelocity, WheelStates, compilable
from ev_doors.learning.environment import Environment
from ev_doors.learning.vector import VectorEnvironment
from ev_msgs_py.contract.fields import SignalError
from ev_msgs_py.refusal import ParameterError

IDS = ev_doors.learning.IDS
LAW = Path(__file__).parents[3] / "docs" / "examples" / "yaw_feedback.py"
CARS = 3
DURATION = 0.05  # 6 steps, the last one of which ends the episode
# Friction of the road, noise, a fault of a motor and one of a signal, and another body: of each car.
DRAWS = {
    "*.vehicle.mass": [1400.0, 1500.0, 1650.0],
    "plant.road.left": [["dry_asphalt"], ["packed_snow_1"], ["wet_asphalt_2"]],
    "plant.sensors.imu_yaw_rate.noise": [0.0, 0.01, 0.02],
    "plant.sensors.wheel_speed.delay": [0, 1, 2],
    "plant.faults": [
        [],
        ["motor_share front_left 0.300 from 0.02"],
        ["constant imu.yaw_rate -1000 from 0.01"],
    ],
    "electronic_differential.faults": [[], ["constant torque_request.drive.front_left 40"], []],
}


def vector_of(name: str, **changes) -> VectorEnvironment:
    given = {"num_envs": CARS, "vectorization_mode": "vector_entry_point", **changes}
    made = gymnasium.make_vec(name, **given)
    assert isinstance(made, VectorEnvironment)
    return made


def singles(name: str, mode: AutoresetMode, vary: dict, **changes) -> SyncVectorEnv:
    """Single environments with the draws of the cars, in the vector of Gymnasium."""

    def one(car: int):
        drawn = {parameter: values[car] for parameter, values in vary.items()}
        return lambda: Environment(**{**IDS[name], "set": drawn, **changes})

    makers = [one(car) for car in range(CARS)]
    return SyncVectorEnv(makers, autoreset_mode=mode, observation_mode="different")


def assert_same(mine, theirs) -> None:
    """Hold what two vectors give against each other, to the bit; frames are compared by themselves."""
    for here, there in zip(mine[:-1], theirs[:-1], strict=True):
        assert here.dtype == there.dtype and here.tobytes() == there.tobytes()
    assert_same_info(mine[-1], {**theirs[-1]})


def assert_same_info(here: dict, there: dict) -> None:
    for name in ("frame", "_frame"):
        there.pop(name, None)
    assert sorted(here) == sorted(there)
    for name, value in here.items():
        mask = here.get(f"_{name}")
        if isinstance(value, dict):
            assert_same_info(
                {each: of if each[0] == "_" else of[mask] for each, of in value.items()},
                {
                    each: of[mask] if isinstance(of, np.ndarray) and each[0] != "_" else of
                    for each, of in there[name].items()
                },
            )
        elif value.dtype == object:
            assert [None if of is None else of.tolist() for of in value] == [
                None if of is None else of.tolist() for of in there[name]
            ]
        else:
            assert value.tobytes() == there[name].tobytes(), name


@compilable
def misspelt(wheel: int) -> float:
    """A reward that asks for what is no signal of its name."""
    return 0.0


@pytest.fixture
def actions():
    """Actions as a learner takes them: of all sizes and signs, some beyond the bounds."""
    return np.random.default_rng(5)


@pytest.mark.parametrize("mode", AutoresetMode)
@pytest.mark.parametrize("name", IDS)
def test_each_car_has_the_bits_of_a_single_environment(name, mode, actions):
    """Over the ends of episodes, early ones too, with a draw and a seed for each car."""
    vary = {**DRAWS}
    if IDS[name]["scenario"] != "double_lane_change":
        vary["*.vehicle.mass"] = [2170.0, 2300.0, 2500.0]
    changes = {"duration": DURATION, "ends": leaves_early}
    mine = vector_of(name, vary=vary, autoreset_mode=mode, **changes)
    theirs = singles(name, mode, vary, **changes)
    assert mine.metadata["autoreset_mode"] is mode
    first = mine.reset(seed=7)
    assert_same(first, theirs.reset(seed=7))
    assert mine.observation_space.contains(first[0])
    high = mine.single_action_space.high
    over = np.zeros(CARS, bool)
    for _ in range(14):
        if mode is AutoresetMode.DISABLED and over.any():
            mask = {"reset_mask": over}
            assert_same(mine.reset(options={**mask}), theirs.reset(options={**mask}))
        chosen = actions.uniform(-1.2, 1.2, (CARS, len(high))) * high
        # Any order in memory will do.
        here, there = mine.step(np.asfortranarray(chosen)), theirs.step(chosen)
        assert_same(here, there)
        over = here[2] | here[3]


@compilable
def leaves_early(body: BodyVelocity, wheels: WheelStates) -> bool:
    """End of an episode as a law: at one of the first instants of one of the cars."""
    return body.longitudinal < 22.0 and wheels.velocity[0] < 75.0


@pytest.mark.weekly
@pytest.mark.parametrize(
    ("name", "changes"),
    [
        ("ev_stack/TorqueSplit-v0", {"scenario": "shchur2019"}),
        ("ev_stack/Steering-v0", {"scenario": "shchur2019"}),
        ("ev_stack/TorqueSplit-v0", {"method": {"electronic_differential": str(LAW)}}),
        ("ev_stack/TractionControl-v0", {"method": {"asr": "pi_slip"}, "vehicle": "layout_1_8_c"}),
        ("ev_stack/TractionControl-v0", {"scenario": "straight_brake_split_mu", "run": "steered"}),
    ],
)
def test_other_scenarios_and_laws_have_the_bits_of_single_environments(name, changes, actions):
    """The kinematic plant, a law of others as the scenario's own, one with a state, a braked car."""
    mine = vector_of(name, duration=DURATION, **changes)
    theirs = singles(name, AutoresetMode.NEXT_STEP, {}, duration=DURATION, **changes)
    assert_same(mine.reset(seed=2), theirs.reset(seed=2))
    for _ in range(14):
        high = mine.action_space.high
        chosen = actions.uniform(-1.0, 1.0, high.shape) * high
        assert_same(mine.step(chosen), theirs.step(chosen))


def test_threads_change_no_bit(actions):
    """Two shares of the cars beside each other, or all one behind the other."""
    made = [vector_of("ev_stack/Steering-v0", num_envs=17, threads=n) for n in (1, 2)]
    assert [len(each._cars._shares) for each in made] == [1, 2]
    for each in made:
        each.reset(seed=1)
    for _ in range(5):
        chosen = actions.normal(size=(17, 1))
        assert_same(*(each.step(chosen) for each in made))


def test_arrays_of_a_step_are_the_readers_own():
    """The next step changes none of them, as a learner keeps what it saw beside what came of it."""
    vector = vector_of("ev_stack/TorqueSplit-v0")
    seen, info = vector.reset(seed=1)
    kept = [seen, info["own"], *vector.step(np.ones((CARS, 2)))[:4]]
    before = [each.copy() for each in kept]
    vector.step(np.full((CARS, 2), 50.0))
    vector.reset(options={"reset_mask": np.array([True, False, False])})
    assert all((each == was).all() for each, was in zip(kept, before, strict=True))
    assert all(each.flags.c_contiguous and each.flags.owndata for each in kept[:3])


def test_a_reward_in_plain_python_gets_arrays_and_one_as_a_law_is_compiled():
    """Both give what they give a single environment, and nothing where an episode begins."""

    def plain(frame, action, own):
        return frame["twist.longitudinal"] + action[..., 0] - own[..., 1]

    def ends(frame):
        return frame["twist.longitudinal"] > 22.3

    for reward, over in ((plain, ends), (speed_and_action, leaves_early)):
        changes = {"reward": reward, "ends": over, "duration": DURATION}
        mine = vector_of("ev_stack/TorqueSplit-v0", **changes)
        theirs = singles("ev_stack/TorqueSplit-v0", AutoresetMode.NEXT_STEP, {}, **changes)
        assert_same(mine.reset(seed=3), theirs.reset(seed=3))
        for n in range(9):
            chosen = np.arange(2.0 * CARS).reshape(CARS, 2) + n
            assert_same(mine.step(chosen), theirs.step(chosen))


@compilable
def speed_and_action(body: BodyVelocity, action, own) -> float:
    """A reward as a law."""
    return body.longitudinal + action[0] - own[1]


@compilable
def at_an_index(action) -> float:
    """A reward that may read beyond its row, or divide by zero."""
    return action[int(action[0])] / action[1]


@pytest.mark.parametrize(
    ("wrong", "reason"),
    [
        (
            [7.0, 1.0],
            r"action\[int\(action\[0\]\)\] is out of range: index 7, length 2, expected -2",
        ),
        ([0.0, 0.0], r"FloatingPointError: invalid value encountered in scalar divide$"),
    ],
)
def test_a_mistake_of_a_reward_as_a_law_names_its_line_and_car(wrong, reason):
    """Compiled code that read beyond the row would read memory of others; 0 would be no reward."""
    line = rf".*test_vector\.py, line \d+: reward law at_an_index: {reason}"
    vector = vector_of("ev_stack/TorqueSplit-v0", reward=at_an_index)
    vector.reset(seed=1)
    assert vector.step(np.array([[1.0, 2.0]] * CARS))[1].tolist() == [1.0] * CARS
    with pytest.raises(ParameterError, match=rf"^car 1: at 0\.02 s: {line}"):
        vector.step(np.array([[1.0, 2.0], wrong, [1.0, 2.0]]))
    single = Environment(**{**IDS["ev_stack/TorqueSplit-v0"], "reward": at_an_index})
    single.reset(seed=1)
    with pytest.raises(ParameterError, match=line):
        single.step(np.array(wrong))


@compilable
def asks_for_more(car) -> float:
    return car.masss


@compilable
def gives_two(action) -> float:
    return action[0], action[1]


@pytest.mark.parametrize(
    ("reward", "reason"),
    [
        (asks_for_more, "AttributeError: masss is not known here, perhaps mass is meant"),
        (gives_two, "gives_two gives a tuple of float64, float64, expected a number"),
    ],
)
def test_a_reward_that_cannot_be_compiled_names_its_line(reward, reason):
    with pytest.raises(ParameterError) as error:
        VectorEnvironment(num_envs=2, reward=reward)
    assert str(error.value).endswith(f"reward law {reward.__name__}: {reason}")
    assert f"{Path(__file__).name}, line " in str(error.value)


def test_the_compiler_names_the_reward_alone():
    """Plain Python finds no mistake in it, and the end is ours."""
    line = r"test_vector\.py, line \d+: takes_a_table: TABLE is of type dict, expected numbers"
    with pytest.raises(ParameterError, match=line):
        VectorEnvironment(num_envs=2, reward=takes_a_table)


TABLE = {"weight": 2.0}


@compilable
def takes_a_table(action) -> float:
    return TABLE["weight"] * action[0]


def test_a_reward_of_others_may_be_interrupted(monkeypatch):
    """Another thread calls it, for it may never end; ours need none."""
    waited = []
    monkeypatch.setattr(
        ev_doors.learning.cars,
        "side_by_side",
        lambda calls, _: waited.append(len(calls)) or [call() for call in calls],
    )
    for changes in ({}, {"reward": speed_and_action}):
        vector_of("ev_stack/TorqueSplit-v0", **changes).reset(seed=1)
    assert waited == [1]


def test_no_reward_changes_the_cars():
    """A frame is read: work in place would move the cars without a word."""
    vector = vector_of("ev_stack/TorqueSplit-v0")
    vector.reset(seed=1)
    with pytest.raises(ValueError, match="read-only"):
        vector.frame["twist.longitudinal"][:] = 0.0


def test_seeds_are_those_of_single_environments():
    """A list has one for each car; the seed of the scenario counts for the first episode."""

    def first(seed=None, of_scenario=None) -> list:
        noise = {"plant.sensors.imu_yaw_rate.noise": 0.01}
        changes = {"set": noise, "observe": ["imu"], "seed": of_scenario}
        vector = vector_of("ev_stack/TorqueSplit-v0", **changes)
        return vector.reset(seed=seed)[0].tolist()

    assert first(4) == first([4, 5, 6]) == first(np.array([4, 5, 6])) == first(of_scenario=4)
    assert first() != first()


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"num_envs": 0}, "num_envs: 0 is refused, expected a whole number, at least 1"),
        ({"autoreset_mode": "Never"}, "unknown autoreset_mode 'Never'"),
        ({"render_mode": "rgb_array"}, "render_mode is refused, expected is Environment for one"),
        ({"threads": 0}, "threads: 0 is refused"),
        (
            {"vary": {"plant.initial_speed": [20.0, 21.0]}},
            "vary has 2 values of each parameter, expected 3, one for each car",
        ),
        ({"vary": {"*.seed": [1] * CARS}}, "vary: *.seed is refused, expected are seeds in reset("),
        ({"vary": {"plant.initial_sped": [20.0] * CARS}}, "unknown parameter of plant"),
        (
            {
                "vary": {
                    "*.vehicle.driven_wheels": [["front_left", "front_right"]] * 2 + [["rear_left"]]
                }
            },
            "car 2 has other driven wheels, expected are the same for all",
        ),
        ({"reward": misspelt}, "reward misspelt asks for wheel: "),
    ],
)
def test_wrong_words_get_one_line(arguments, message):
    with pytest.raises(ParameterError) as error:
        VectorEnvironment(**{"num_envs": CARS, **arguments})
    assert str(error.value).startswith(message)


def test_wrong_calls_get_one_line():
    """Nothing is done then: the next step goes on from the same instant."""
    vector = vector_of("ev_stack/TorqueSplit-v0", autoreset_mode="Disabled", duration=0.01)
    with pytest.raises(ParameterError, match=r"^step is refused before the first reset"):
        vector.step(np.zeros((CARS, 2)))
    with pytest.raises(ParameterError, match=r"^reset_mask is refused, expected is a reset of all"):
        vector.reset(options={"reset_mask": np.array([True, False, False])})
    vector.reset(seed=1)
    for mask in (np.zeros(CARS, bool), np.ones(CARS), np.ones(2, bool)):
        with pytest.raises(ParameterError, match=r"^reset_mask of .* is refused, expected are 3"):
            vector.reset(options={"reset_mask": mask})
    with pytest.raises(ParameterError, match=r"^reset option 'x' is refused, expected is reset_m"):
        vector.reset(options={"x": 1})
    with pytest.raises(ParameterError, match=r"^seed has 2 numbers, expected 3"):
        vector.reset(seed=[1, 2])
    for seed in (-1, [1, -1, 2], 1.5, "123", [1, 2, "3"]):
        with pytest.raises(ParameterError, match=r"^seed: .* is refused, expected (are|a) whole"):
            vector.reset(seed=seed)
    with pytest.raises(ParameterError, match=r"^options: 'abc' is refused"):
        vector.reset(options="abc")
    with pytest.raises(
        ParameterError, match=r"^action of shape \(2,\) is refused, expected \(3, 2\)"
    ):
        vector.step(np.zeros(2))
    with pytest.raises(ParameterError, match=r"is refused, expected are finite numbers$"):
        vector.step(np.full((CARS, 2), np.nan))
    with pytest.raises(ParameterError, match=r"is refused, expected are finite numbers$"):
        # Finite before it becomes a float.
        vector.step(np.full((CARS, 2), np.longdouble("1e400")))
    for time in (0.01, 0.02):
        assert vector.step(np.zeros((CARS, 2)))[-1]["time"].tolist() == [time] * CARS
    with pytest.raises(ParameterError, match=r"^step is refused: the episode of car 0 is over"):
        vector.step(np.zeros((CARS, 2)))
    with pytest.raises(TypeError, match="cannot be copied or pickled"):
        copy.deepcopy(vector)


def test_a_number_that_is_not_finite_names_its_car():
    """Nothing goes on from there but a reset, which gives the bits of the first one."""
    vector = vector_of("ev_stack/Steering-v0")
    first, _ = vector.reset(seed=1)
    with pytest.raises(SignalError, match=r"^car 1: at 0\.01 s: steering_column: Steering.* is "):
        for _ in range(3):
            vector.step(np.array([[0.0], [1e308], [0.0]]))
    with pytest.raises(ParameterError, match=r"^step is refused before the first reset"):
        vector.step(np.zeros((CARS, 1)))
    assert vector.reset(seed=1)[0].tolist() == first.tolist()


def test_former_ids_go_on():
    made = gymnasium.make_vec("ev_sim/Steering-v0", num_envs=2)
    assert isinstance(made, VectorEnvironment) and made.num_envs == 2
