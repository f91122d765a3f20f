"""Fig 4 of Shchur (2019): the driving cycle."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ev_papers.shchur2019 import paper
from ev_papers.shchur2019.assumptions import (
    ACKERMANN,
    FIVE_TIMES,
    SET_ANGLE,
    SET_SPEED,
    SIGN_OF_RADIUS,
    five_times_and_drives,
)
from ev_papers.shchur2019.steps import ASSISTED
from ev_sim.measures import motion
from ev_sim.measures.samples import channel, mean_between, run_named
from ev_sim.recording.recording import Recording
from ev_sim.verdicts.check import Measure, Number, absolute, relative
from ev_sim.verdicts.declaration import Declaration, judged, not_judgeable
from ev_sim.verdicts.need import ScenarioNeed, ScenarioRuns

CYCLE = ScenarioNeed("shchur2019")
_RUN = "shchur2019"
LEFT = (paper.LEFT_TURN[1] - 1.0, paper.LEFT_TURN[1])  # last second of the turn [s]
RIGHT = (paper.RIGHT_TURN[1] - 1.0, paper.RIGHT_TURN[1])
SLOW = (paper.SECOND_ACCELERATION[0] - 1.0, paper.SECOND_ACCELERATION[0])  # last second of straight running [s]
FAST = (49.0, 50.0)

Quantity = Callable[[Recording], np.ndarray]


def cycle_run(driven: ScenarioRuns) -> Recording:
    """The run of the cycle."""
    return run_named(driven.runs, _RUN)


def mean_in(quantity: Quantity, window: tuple[float, float]) -> Measure:
    """Mean of a quantity in a window [s] of the cycle."""
    return lambda driven: mean_between(cycle_run(driven), quantity(cycle_run(driven)), *window)


def _mean_while_held(quantity: Quantity, angle: float, window: tuple[float, float]) -> Measure:
    return lambda driven: motion.mean_while_held(cycle_run(driven), quantity(cycle_run(driven)), angle, *window)


def recorded(name: str) -> Quantity:
    """A channel of the recording."""
    return lambda run: channel(run, name)


def _reached(speed: float, after: float) -> Measure:
    """When the speed comes within 1 % of `speed` [m/s] for the first time after an instant [s], at the end if never."""

    def measure(driven: ScenarioRuns) -> float:
        run = cycle_run(driven)
        there = run.time[(run.time >= after) & (np.abs(motion.path_speed(run) - speed) <= 0.01 * speed)]
        return float(there[0] if len(there) else run.time[-1])

    return measure


def _speed(id: str, speed: float, acceleration: tuple[float, float], window: tuple[float, float]) -> Declaration:
    return judged(
        id,
        CYCLE,
        Number(
            "km/h", 3.6 * speed, relative(0.01, "plateau"), mean_in(lambda run: 3.6 * motion.path_speed(run), window)
        ),
        Number(
            "s", acceleration[1], absolute(1.0, "no speed controller is given"), _reached(speed, acceleration[0]), "at"
        ),
        inputs=SET_SPEED,
    )


def _turn(side: str, angle: float, window: tuple[float, float]) -> tuple[Declaration, Declaration]:
    """Steering angle and differential torque of one turn."""
    torque = np.sign(angle) * paper.differential_torque(ASSISTED, paper.TURN_ANGLE)
    return (
        judged(
            f"shchur.fig4.delta.{side}",
            CYCLE,
            Number(
                "rad",
                angle,
                absolute(np.radians(0.5), "what is left of the turn-in, which is not given, and ripple of the drives"),
                mean_in(recorded(motion.ROAD_WHEEL_ANGLE), window),
            ),
            inputs=SET_ANGLE,
        ),
        judged(
            f"shchur.fig4.dM.{side}",
            CYCLE,
            Number(
                "N m",
                torque,
                relative(0.01, "the angle is at rest, but for ripple of the drives"),
                _mean_while_held(motion.differential_torque, angle, window),
            ),
            assumption=five_times_and_drives,
        ),
    )


def _difference_beyond_the_law(driven: ScenarioRuns) -> float:
    """Largest distance of M_R* - M_L* from eq 4 with the column's own signals [N m]."""
    run = cycle_run(driven)
    column = "steering_column.state"
    law = (
        paper.differential_torque(1.0, 0.0)
        / paper.GAMMA
        * (
            paper.GAMMA * channel(run, f"{column}.hand_torque")
            - paper.K_CK * channel(run, f"{column}.angle")
            - paper.B_CK * channel(run, f"{column}.rate")
        )
    )
    return float(np.abs(motion.differential_torque(run) - law).max())


def _sum_beyond_the_driver(driven: ScenarioRuns) -> float:
    """Largest distance of M_R* + M_L* from M* [N m]."""
    run = cycle_run(driven)
    both = channel(run, "torque_request.drive.front_right") + channel(run, "torque_request.drive.front_left")
    return float(np.abs(both - channel(run, "driver.command.drive_torque")).max())


_SLOW, _FAST = paper.SPEED_LEFT_TURN, paper.SPEED_RIGHT_TURN
_SHAPE = relative(0.10, "the shape of the ramp is not given")
_RESISTANCE = relative(0.01, "the acceleration of gravity is not printed")
_IDENTITY = absolute(1e-9, "an identity, but for rounding")

_CYCLE_DECLARATIONS: tuple[Declaration, ...] = (
    _speed("shchur.fig4.V1", _SLOW, paper.FIRST_ACCELERATION, SLOW),
    _speed("shchur.fig4.V2", _FAST, paper.SECOND_ACCELERATION, FAST),
    judged(
        "shchur.fig4.M.plateau",
        CYCLE,
        Number(
            "N m", paper.resisting_torque(_SLOW**2), _RESISTANCE, mean_in(motion.total_drive_torque, SLOW), "15 km/h"
        ),
        Number(
            "N m", paper.resisting_torque(_FAST**2), _RESISTANCE, mean_in(motion.total_drive_torque, FAST), "30 km/h"
        ),
    ),
    judged(
        "shchur.fig4.M.acceleration",
        CYCLE,
        Number(
            "N m",
            paper.accelerating_torque(0.0, _SLOW, 4.0),
            _SHAPE,
            mean_in(motion.total_drive_torque, paper.FIRST_ACCELERATION),
            "first",
        ),
        Number(
            "N m",
            paper.accelerating_torque(_SLOW, _FAST, 4.0),
            _SHAPE,
            mean_in(motion.total_drive_torque, paper.SECOND_ACCELERATION),
            "second",
        ),
    ),
    *_turn("left", paper.TURN_ANGLE, LEFT),
    *_turn("right", -paper.TURN_ANGLE, RIGHT),
    judged(
        "shchur.fig4.references",
        CYCLE,
        Number("N m", 0.0, _IDENTITY, _difference_beyond_the_law, "difference"),
        Number("N m", 0.0, _IDENTITY, _sum_beyond_the_driver, "sum"),
        assumption=FIVE_TIMES,
    ),
    not_judgeable(
        "shchur.fig4.drive_torques", "curve not in the text; its ripple needs current control and bus voltage"
    ),
    not_judgeable(
        "shchur.fig4.transients", "curves not in the text; speed controller, limits and turn-in are not given"
    ),
)


_TURNS = ((LEFT, paper.SPEED_LEFT_TURN, paper.TURN_ANGLE), (RIGHT, paper.SPEED_RIGHT_TURN, -paper.TURN_ANGLE))


def _wheel_speeds() -> tuple[Number, ...]:
    return tuple(
        Number(
            "rad/s",
            value,
            relative(0.01, "the driver holds the angle"),
            mean_in(recorded(f"wheel_states.velocity.front_{side}"), window),
            f"{turn} {name}",
        )
        for turn, (window, speed, angle) in zip(("left", "right"), _TURNS, strict=True)
        for side, name, value in zip(("right", "left"), "RL", paper.wheel_speeds(speed, angle), strict=True)
    )


def _speed_differences() -> tuple[Number, ...]:
    def difference(window: tuple[float, float]) -> Measure:
        return lambda driven: mean_between(
            cycle_run(driven), motion.speed_difference(cycle_run(driven), driven.vehicle), *window
        )

    return tuple(
        Number(
            "m/s",
            paper.speed_difference(speed, angle),
            relative(0.01, "the driver holds the angle"),
            difference(window),
            turn,
        )
        for turn, (window, speed, angle) in zip(("left", "right"), _TURNS, strict=True)
    )


_CYCLE_WHEEL_SPEEDS_DECLARATIONS: tuple[Declaration, ...] = (
    judged("shchur.fig4.wheel_speeds", CYCLE, *_wheel_speeds(), inputs=f"{ACKERMANN}; {SIGN_OF_RADIUS}"),
    judged("shchur.fig4.dV", CYCLE, *_speed_differences(), inputs=f"{ACKERMANN}; {SIGN_OF_RADIUS}"),
)


DECLARATIONS = (*_CYCLE_DECLARATIONS, *_CYCLE_WHEEL_SPEEDS_DECLARATIONS)
