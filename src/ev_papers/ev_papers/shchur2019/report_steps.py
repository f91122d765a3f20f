"""Report on the steps of Shchur (2019): figs. 1a and 1b, and 30 deg held with and without the law.

Runs: `object` (column alone, step of 5 N m by hand), `closed_loop` (power steering, step of 1 N m),
`hold_manual` and `hold_assisted` (the driver holds 30 deg without and with the law).
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from ev_core.vehicle.description import Vehicle
from ev_papers.shchur2019 import paper
from ev_stack.figures.panels import Curve, Panel, panel
from ev_stack.figures.sheets import Sheet
from ev_stack.measures import motion
from ev_stack.measures.metric import Metric, Parameters, Runs, channel, run_named
from ev_stack.recording.recording import Recording
from ev_study.verdicts.need import ScenarioRuns
from ev_study.verdicts.verdict import metrics_at_hand

SHOWN = 5.0  # of the published curves [s after the step]
SINCE_STEP = "time after the step [s]"
# Torques about the kingpins [N m]: of the object by hand alone, of the loop with the assistance.
OBJECT_TORQUE = paper.I_RATIO * paper.HAND_TORQUE_OBJECT
CLOSED_LOOP_TORQUE = (1 + paper.GAMMA) * paper.I_RATIO * paper.HAND_TORQUE_CLOSED_LOOP


def metrics(runs: Runs, vehicle: Vehicle, parameters: Parameters) -> dict[str, Metric]:
    """Numbers by which figs. 1a and 1b and the hand torques at 30 deg are judged."""
    driven = ScenarioRuns(runs, vehicle, parameters)
    return metrics_at_hand("shchur2019", "shchur2019_steps", driven)


def figures(runs: Runs) -> dict[str, Sheet]:
    """Fig. 1 as one sheet."""
    return {"fig1": Sheet(list(panels(runs).values()), SINCE_STEP, columns=1, start=0.0)}


def panels(runs: Runs) -> dict[str, Panel]:
    """Fig. 1: a, road-wheel angle of object and closed loop; b, differential torque."""

    def angles() -> list[Curve]:
        return [
            _after_step(runs, "object", _road_wheel_angle, "1: object, 5 N m by hand"),
            _after_step(runs, "closed_loop", _road_wheel_angle, "2: closed loop, 1 N m by hand"),
            _published(lambda time: _published_angle(paper.OBJECT, OBJECT_TORQUE, time)),
            _published(lambda time: _published_angle(paper.CLOSED_LOOP, CLOSED_LOOP_TORQUE, time)),
        ]

    def torques() -> list[Curve]:
        ours = _after_step(runs, "closed_loop", motion.differential_torque, "ours")
        return [ours, _published(_published_torque)]

    return {
        "a": panel("a  Road-wheel angle", "angle [deg]", angles),
        "b": panel("b  Differential torque, right minus left", "torque [N m]", torques),
    }


def _after_step(
    runs: Runs, name: str, quantity: Callable[[Recording], np.ndarray], label: str
) -> Curve:
    run = run_named(runs, name)
    return Curve(run.time - motion.hand_torque_step_time(run), quantity(run), label)


def _road_wheel_angle(run: Recording) -> np.ndarray:
    return np.degrees(channel(run, motion.ROAD_WHEEL_ANGLE))


def _published(quantity: Callable[[float], float]) -> Curve:
    """Curve of a quantity over the time after the step [s], by the printed parameters."""
    time = np.linspace(0.0, SHOWN, 401)
    values = np.array([quantity(each) for each in time])
    return Curve(time, values, "published", published=True)


def _published_angle(system: paper.SecondOrder, torque: float, time: float) -> float:
    """Answer of the road-wheel angle to a step of the torque [N m], eqs 6 and 7 [deg]."""
    return math.degrees(system.steady_angle(torque) * (1 + system.deviation(time)))


def _published_torque(time: float) -> float:
    """Differential torque of the closed loop, eqs 4 and 7 [N m]."""
    steady = paper.CLOSED_LOOP.steady_angle(CLOSED_LOOP_TORQUE)
    angle = steady * (1 + paper.CLOSED_LOOP.deviation(time))
    rate = steady * paper.CLOSED_LOOP.rate(time)
    return paper.differential_torque(paper.HAND_TORQUE_CLOSED_LOOP, angle, rate)
