"""Train policy.py in Gymnasium environments by evolution (CMA-ES), and write its weights as a parameter file.

    python docs/examples/learned/train.py my_policy.yaml [--generations 25] [--seed 1] [--duration 6]
    scripts/run.sh benchmark --add docs/examples/learned/policy.py=my_policy.yaml --laws pi

The network has 15 weights, so a search without gradients is enough, and no framework for deep
learning is needed.
"""

import argparse
from math import atan2
from pathlib import Path

import cma
import gymnasium
import numpy as np
from policy import WEIGHTS

import ev_doors.learning  # noqa: F401, registers the environments
from ev_core.law import GRAVITY
from ev_core.lockstep.configuration import configure
from ev_core.parameters.declaration import flatten
from ev_stack.interface.simulation import SteppedLaw

ROLE, LAW = "electronic_differential", str(Path(__file__).with_name("policy.py"))
CARS = ("compact_ev", "layout_1_8_c")
MANOEUVRES = {"double_lane_change": "", "sine_with_dwell": "times_3_5"}  # and their runs
ROADS = ("dry_asphalt", "wet_asphalt_2", "packed_snow_1")
NOISE = {"plant.sensors.imu_yaw_rate.noise": 0.005, "plant.sensors.imu_acceleration.noise": 0.1}
LARGE_SIDESLIP, LARGE_ERROR, SPUN, LOST = 0.05, 1.0, 0.5, 100.0  # rad, m/s^2, rad, 1


def environment(car: str, scenario: str, road: str, duration: float) -> gymnasium.Env:
    """A car in a manoeuvre on a road; an episode is over when the car has turned away.

    The reward is minus squares of the sideslip, and of the yaw rate beside the one that steering
    and friction allow: who trains knows the friction, the policy does not.
    """
    values = {"plant.road.left": [road], "plant.road.right": [road], **NOISE}
    if scenario == "sine_with_dwell":
        values["steering_column.scale"] = 1.0

    def reward(frame, action, own):
        speed, most = (
            frame["twist.longitudinal"],
            0.85 * GRAVITY * frame["tire_forces.friction_coefficient.front_left"],
        )
        neutral = speed * speed * frame["steering_column.state.road_wheel_angle"] / wheelbase
        error = (speed * frame["twist.yaw_rate"] - min(max(neutral, -most), most)) / LARGE_ERROR
        return max(-((sideslip(frame) / LARGE_SIDESLIP) ** 2 + error * error), -LOST)

    made = gymnasium.make(
        "ev_stack/TorqueSplit-v0", disable_env_checker=True, scenario=scenario, run=MANOEUVRES[scenario], vehicle=car,
        set=values, duration=duration, reward=reward, ends=lambda frame: abs(sideslip(frame)) > SPUN,
    ).unwrapped  # fmt: skip
    wheelbase = made.simulation.configurations[ROLE].common.vehicle.wheelbase
    return made


def sideslip(frame) -> float:
    """Of the car [rad]."""
    return atan2(frame["twist.lateral"], max(frame["twist.longitudinal"], 1.0))


def loss(environment: gymnasium.Env, weights: list[float], seed: int) -> float:
    """Minus the mean reward of an episode with the policy; a car that is lost gets the least reward for the rest."""
    common = flatten(environment.simulation.configurations[ROLE].common)
    policy = SteppedLaw(configure(ROLE, {**common, "method": LAW, "weights": weights}))
    _, info = environment.reset(seed=seed)
    rewards, lost, over = [], False, False
    while not (lost or over):
        answer = policy.answer(info["time"], info["frame"])
        _, reward, lost, over, info = environment.step(
            np.array([answer[name] for name in environment.channels])
        )
        rewards.append(reward)
    left = 1.0 - info["time"] / environment.simulation.duration if lost else 0.0
    return -float(np.mean(rewards)) * (1.0 - left) + LOST * left


parser = argparse.ArgumentParser()
parser.add_argument("file", type=Path)
parser.add_argument("--generations", type=int, default=25)
parser.add_argument("--seed", type=int, default=1)
parser.add_argument("--duration", type=float, default=6.0, help="of an episode [s]")
given = parser.parse_args()

courses = [
    environment(car, scenario, road, given.duration)
    for car in CARS
    for scenario in MANOEUVRES
    for road in ROADS
]
random = np.random.default_rng(given.seed)
options = {
    "seed": np.nan,
    "randn": lambda *shape: random.standard_normal(shape),
    "verbose": -9,
    "bounds": [-100, 100],
}
strategy = cma.CMAEvolutionStrategy(np.zeros(WEIGHTS), 0.5, options)
for generation in range(given.generations):
    asked, seed = strategy.ask(), int(random.integers(2**31))
    losses = [
        float(np.mean([loss(course, weights.tolist(), seed) for course in courses]))
        for weights in asked
    ]
    strategy.tell(asked, losses)
    print(
        f"generation {generation + 1}: least mean loss {min(losses):.4f}, of {len(asked)} policies"
    )
mean = strategy.result.xfavorite.tolist()
own, none = (
    np.mean([loss(course, weights, given.seed) for course in courses])
    for weights in (mean, [0.0] * WEIGHTS)
)
print(f"loss {own:.4f}, of equal torques {none:.4f}")
given.file.write_text(
    f"# python docs/examples/learned/train.py --generations {given.generations} --seed {given.seed}"
    f" --duration {given.duration:g}\n/**/{ROLE}:\n  ros__parameters:\n    weights: {mean!r}\n"
)
