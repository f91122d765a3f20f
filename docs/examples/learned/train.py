"""Train policy.py on many cars at once by evolution (CMA-ES), and write its weights as a file.

    python docs/examples/learned/train.py my_policy.yaml [--figure curve.png] [--generations 25]
    scripts/run.sh benchmark --add docs/examples/learned/policy.py=my_policy.yaml --laws pi

Its task are the sine with dwell and the lane change of the small board, on all roads, with the cars
that the board is tuned on. All candidates of a generation drive all draws of a cell in one vector.
At the end the policy drives cars, roads and draws that were held out. The network has 15 weights:
a search without gradients is enough, and no framework for deep learning is needed.
"""

import argparse
from dataclasses import replace
from pathlib import Path

import cma
import gymnasium
import numpy as np
from matplotlib.figure import Figure
from policy import WEIGHTS, PolicyParameters, drive_torques, inputs, share_of_moment, speed_of

import ev_doors.learning  # noqa: F401, registers the environments
from ev_core.law import (
    GRAVITY,
    BodyVelocity,
    Car,
    SteeringColumnState,
    TireForces,
    Wheels,
    atan2,
    compilable,
)
from ev_core.methods.law import namespace
from ev_core.vehicle.car import car_numbers
from ev_stack.scenarios.records import Run
from ev_study.benchmark.board import Board, Cell, read_board
from ev_study.benchmark.cell_runs import SEEDS
from ev_study.benchmark.driving import laws_in_cell
from ev_study.benchmark.held_out import held_out, with_cases

ROLE = "electronic_differential"
MANOEUVRES = ("sine_with_dwell", "double_lane_change")
SEEN = (
    "driver.command.drive_torque", "steering_column.state.road_wheel_angle", "imu.yaw_rate",
    "imu.lateral_acceleration", "wheel_states.velocity",
)  # fmt: skip
LARGE_SIDESLIP, LARGE_ERROR, SPUN, LOST = 0.05, 1.0, 0.5, 100.0  # rad, m/s^2, rad, 1
POLICY = PolicyParameters()


@compilable
def sideslip(body: BodyVelocity) -> float:
    """Of the car [rad]."""
    return atan2(body.lateral, max(body.longitudinal, 1.0))


@compilable
def holds_its_way(
    car: Car, body: BodyVelocity, column: SteeringColumnState, tyres: TireForces
) -> float:
    """Minus squares of sideslip and of the yaw rate beside what steering and friction allow.

    Who trains knows the friction, the policy does not.
    """
    speed, most = body.longitudinal, 0.85 * GRAVITY * tyres.friction_coefficient[0]
    neutral = speed * speed * column.road_wheel_angle / car.wheelbase
    error = (speed * body.yaw_rate - min(max(neutral, -most), most)) / LARGE_ERROR
    slip = sideslip(body) / LARGE_SIDESLIP
    return max(-(slip * slip + error * error), -LOST)


@compilable
def has_spun(body: BodyVelocity) -> bool:
    """End of an episode: the car has turned away."""
    return abs(sideslip(body)) > SPUN


class Course:
    """A cell of the board with all its draws, for so many candidates at once."""

    def __init__(self, board: Board, cell: Cell, candidates: int, duration: float) -> None:
        runs = laws_in_cell(board, cell, [board.reference])[board.reference]
        vary = {name: [*column] * candidates for name, column in runs.vary.items()}
        self.seeds, self.draws = np.array(vary.pop(SEEDS)), board.draws
        self.run = replace(runs.run, duration=min(runs.run.duration, duration))
        self.vary = vary
        self.vector = self.vector_of(self.run)
        vehicle = self.run.configurations[ROLE].common.vehicle
        self.car = namespace(car_numbers(vehicle))
        # A law knows the wheelbase of its own car.
        self.car.wheelbase = np.array(vary.get("*.vehicle.wheelbase", vehicle.wheelbase))
        self.driven = np.flatnonzero(self.car.driven)
        self.steps = round(self.run.duration * 1e9 / self.run.period)

    def vector_of(self, run: Run) -> gymnasium.vector.VectorEnv:
        """All cars in a run."""
        return gymnasium.make_vec(
            "ev_stack/TorqueSplit-v0",
            num_envs=len(self.seeds),
            vectorization_mode="vector_entry_point",
            scenario=run,
            observe=SEEN,
            reward=holds_its_way,
            ends=has_spun,
            vary=self.vary,
        )

    def actions(self, weights: np.ndarray, seen: np.ndarray) -> np.ndarray:
        """Torques of the policy for all cars, as its law computes them."""
        total, angle, yaw_rate, across, *turning = seen.T
        speed = speed_of(self.car, Wheels(*turning))
        x = inputs(self.car, speed, angle, yaw_rate, across)
        moment = POLICY.largest * share_of_moment(weights, *x) * (speed > POLICY.slowest)
        torques = drive_torques(self.car, total, moment)
        return np.stack([torques[wheel] for wheel in self.driven], axis=1)

    def losses(self, candidates: np.ndarray, seed: int) -> np.ndarray:
        """Mean loss of each candidate in each draw; that of a lost car is the largest one."""
        weights = np.repeat(candidates, self.draws, axis=0).T
        # The same noise for all candidates, another one in each generation.
        seen, _ = self.vector.reset(seed=((self.seeds + seed) % 2**31).tolist())
        lost, total = np.zeros(len(self.seeds), bool), np.zeros(len(self.seeds))
        for _ in range(self.steps):
            seen, rewards, ended, *_ = self.vector.step(self.actions(weights, seen))
            lost |= ended
            total -= np.where(lost, -LOST, rewards)
        return (total / self.steps).reshape(len(candidates), self.draws)


def courses_of(board: Board, candidates: int, duration: float, pattern: str) -> list[Course]:
    """All cells of the task that fit a pattern."""
    cells = [cell for cell in board.cells(pattern) if cell.manoeuvre in MANOEUVRES]
    return [Course(board, cell, candidates, duration) for cell in cells]


def losses_of(courses: list[Course], candidates: np.ndarray, seed: int) -> np.ndarray:
    """Loss of each candidate in each run, (candidates, runs)."""
    return np.concatenate([course.losses(candidates, seed) for course in courses], axis=1)


def draw(curve: list[tuple[float, ...]], file: Path) -> None:
    """Draw the losses by generation."""
    figure = Figure(figsize=(6.0, 3.0), layout="constrained")
    axes = figure.add_subplot()
    for label, column in zip(
        ("equal torques", "mean policy", "best policy"), zip(*curve, strict=True), strict=True
    ):
        axes.plot(range(1, len(curve) + 1), column, label=label)
    axes.set(xlabel="generation", ylabel="loss [1]", yscale="log")
    axes.set_yticks([2, 5, 10, 20], ["2", "5", "10", "20"])
    axes.minorticks_off()
    axes.legend()
    figure.savefig(file, dpi=100)


def main() -> None:
    """Train, write the weights, and drive what was held out."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("file", type=Path)
    parser.add_argument("--figure", type=Path, help="losses by generation")
    parser.add_argument("--generations", type=int, default=25)
    parser.add_argument("--candidates", type=int, default=16, help="in each generation")
    parser.add_argument("--draws", type=int, default=2, help="of each cell in training")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--duration", type=float, default=6.0, help="longest episode [s]")
    parser.add_argument("--cells", default="*", help="pattern, as *:sine_with_dwell:wet:*")
    given = parser.parse_args()
    board = read_board("small")
    training = replace(with_cases(board, "training", given.seed), draws=given.draws)
    # The first one of each generation are equal torques: no weights.
    courses = courses_of(training, given.candidates + 1, given.duration, given.cells)
    random = np.random.default_rng(given.seed)
    options = {
        "seed": np.nan, "randn": lambda *shape: random.standard_normal(shape), "verbose": -9,
        "bounds": [-100, 100], "popsize": given.candidates,
    }  # fmt: skip
    strategy = cma.CMAEvolutionStrategy(np.zeros(WEIGHTS), 0.5, options)
    curve: list[tuple[float, ...]] = []
    for generation in range(given.generations):
        asked, seed = strategy.ask(), int(random.integers(2**31))
        losses = losses_of(courses, np.array([np.zeros(WEIGHTS), *asked]), seed).mean(axis=1)
        strategy.tell(asked, losses[1:].tolist())
        curve.append((losses[0], losses[1:].mean(), losses[1:].min()))
        print(
            "generation {}: equal torques {:.3f}, mean {:.3f}, best {:.3f}".format(
                generation + 1, *curve[-1]
            )
        )
    weights = strategy.result.xfavorite
    given.file.write_text(
        f"# python docs/examples/learned/train.py --generations {given.generations}"
        f" --seed {given.seed} --candidates {given.candidates} --draws {given.draws}\n"
        f"/**/{ROLE}:\n  ros__parameters:\n    weights: {weights.tolist()!r}\n"
    )
    if given.figure:
        draw(curve, given.figure)
    unknown = replace(held_out(board, given.seed), draws=5 * given.draws)
    courses = courses_of(unknown, 2, given.duration, given.cells)
    equal, own = losses_of(courses, np.array([np.zeros(WEIGHTS), weights]), given.seed)
    print(
        f"held out, {equal.size} runs: loss {own.mean():.3f}, of equal torques {equal.mean():.3f};"
        f" less in {(own < equal).sum()}"
    )


if __name__ == "__main__":
    main()
