"""Report on the steps of Shchur (2019): figs. 1a and 1b, and holding 30 deg with and without the law.

Runs: `object` (column alone, step of 5 N m by hand), `closed_loop` (power steering, step of 1 N m), `hold_manual` and
`hold_assisted` (the driver holds 30 deg without and with the law).
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from ev_core.vehicle.description import Vehicle
from ev_papers.shchur2019 import paper
from ev_sim.figures.panels import Curve, Panel, panel
from ev_sim.figures.sheets import Sheet
from ev_sim.measures import motion
from ev_sim.measures.metric import Metric, Parameters, Runs, channel, run_named
from ev_sim.recording.recording import Recording
from ev_study.verdicts.need import ScenarioRuns
from ev_study.verdicts.verdict import metrics_at_hand

SHOWN = 5.0  # of the published curves [s after the step]
SINCE_STEP = "time after the step [s]"


def metrics(runs: Runs, vehicle: Vehicle, parameters: Parameters) -> dict[str, Metric]:
    """What figs. 1a and 1b and the hand torques at 30 deg are judged by."""
    return metrics_at_hand("shchur2019", "shchur2019_steps", ScenarioRuns(runs, vehicle, parameters))


def panels(runs: Runs) -> dict[str, Panel]:
    """Fig. 1: a, road-wheel angle of the object and of the closed loop; b, differential torque."""

    def after_step(name: str, quantity: Callable[[Recording], np.ndarray], label: str = "") -> Curve:
        run = run_named(runs, name)
        return Curve(run.time - motion.hand_torque_step_time(run), quantity(run), label)

    return {
        "a": panel(
            "a  Road-wheel angle",
            "angle [deg]",
            lambda: [
                after_step("object", _road_wheel_angle, "1: object, 5 N m by hand"),
                after_step("closed_loop", _road_wheel_angle, "2: closed loop, 1 N m by hand"),
                *(
                    _published(lambda time, system=system: math.degrees(_answer(*system, time)[0]))
                    for system in (_OBJECT, _CLOSED_LOOP)
                ),
            ],
        ),
        "b": panel(
            "b  Differential torque, right minus left",
            "torque [N m]",
            lambda: [after_step("closed_loop", motion.differential_torque, "ours"), _published(_torque)],
        ),
    }


def _published(quantity: Callable[[float], float]) -> Curve:
    """What follows from eqs 4, 6 and 7 with the printed parameters, of the time after the step [s]."""
    time = np.linspace(0.0, SHOWN, 401)
    return Curve(time, np.array([quantity(t) for t in time]), "published", published=True)


# Of curves 1 and 2 what turns, and by which torque about the kingpins [N m].
_OBJECT = paper.OBJECT, paper.I_RATIO * paper.HAND_TORQUE_OBJECT
_CLOSED_LOOP = paper.CLOSED_LOOP, (1 + paper.GAMMA) * paper.I_RATIO * paper.HAND_TORQUE_CLOSED_LOOP


def _answer(system: paper.SecondOrder, torque: float, time: float) -> tuple[float, float]:
    """Angle [rad] and rate [rad/s]."""
    steady = system.steady_angle(torque)
    return steady * (1 + system.deviation(time)), steady * system.rate(time)


def _torque(time: float) -> float:
    return paper.differential_torque(paper.HAND_TORQUE_CLOSED_LOOP, *_answer(*_CLOSED_LOOP, time))


def figures(runs: Runs) -> dict[str, Sheet]:
    """Fig. 1 as one sheet."""
    return {"fig1": Sheet(list(panels(runs).values()), SINCE_STEP, columns=1, start=0.0)}


def _road_wheel_angle(run: Recording) -> np.ndarray:
    return np.degrees(channel(run, motion.ROAD_WHEEL_ANGLE))
