"""Shchur (2019), with the report of his driving cycle: fig. 4, a run of 50 s with two turns.

The right turn (30 deg at 30 km/h) would need a lateral acceleration of about 1.6 g: the kinematic
plant reproduces it as the paper computes it, a plant with tyres does not.

A source has its place ORDER, its PANELS, and in MEASURES the functions that published.csv names.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ev_core.vehicle.description import Vehicle
from ev_papers.shchur2019 import measures, paper, report_steps
from ev_stack.figures.panels import Curve, Panel, degrees, level, panel
from ev_stack.figures.sheets import Sheet
from ev_stack.measures import motion
from ev_stack.measures.metric import Metric, Parameters, Runs, channel, run_named
from ev_stack.recording.recording import Recording
from ev_study.verdicts.measure import measures_of
from ev_study.verdicts.need import ScenarioNeed, ScenarioRuns
from ev_study.verdicts.panels_page import PublishedPanel, over_time, scheme
from ev_study.verdicts.verdict import metrics_at_hand

ORDER = 0  # among the sources, in tables
MEASURES = measures_of(measures)
RUN = "shchur2019"
END = 50.0  # of the cycle [s]
_STEPS_OF_A = ("1.steady", "1.overshoot", "1.settling", "2.steady", "2.overshoot", "2.settling")


def metrics(runs: Runs, vehicle: Vehicle, parameters: Parameters) -> dict[str, Metric]:
    """Numbers by which fig. 4 is judged."""
    return metrics_at_hand("shchur2019", RUN, ScenarioRuns(runs, vehicle, parameters))


def figures(runs: Runs, vehicle: Vehicle) -> dict[str, Sheet]:
    """Fig. 4 as one sheet, with the panels of the paper."""
    return {"fig4": Sheet(list(panels(runs, vehicle).values()))}


def panels(runs: Runs, vehicle: Vehicle) -> dict[str, Panel]:
    """Panels of fig. 4 by their quantity, with what is printed or follows, in the paper's order."""

    def one(
        title: str, ylabel: str, quantity: Callable[[Recording], np.ndarray], key: str
    ) -> Panel:
        def curves() -> list[Curve]:
            run = run_named(runs, RUN)
            return [Curve(run.time, quantity(run), "ours"), *_published(key)]

        return panel(title, ylabel, curves)

    def both_front_wheels(title: str, ylabel: str, quantity: str) -> Panel:
        def curves() -> list[Curve]:
            run = run_named(runs, RUN)
            right = Curve(run.time, channel(run, f"{quantity}.front_right"), "right")
            left = Curve(run.time, channel(run, f"{quantity}.front_left"), "left")
            return [right, left, *_published(quantity)]

        return panel(title, ylabel, curves)

    torque, speed = "torque [N m]", "speed [m/s]"
    angle = degrees(lambda run: channel(run, motion.ROAD_WHEEL_ANGLE))
    return {
        "V": one("Speed", speed, motion.path_speed, "V"),
        "M": one("Total torque at the wheels", torque, motion.total_drive_torque, "M"),
        "delta": one("Steering angle", "angle [deg]", angle, "delta"),
        "dM": one(
            "Differential torque, right minus left",
            torque,
            motion.differential_torque,
            "dM",
        ),
        "references": both_front_wheels(
            "Torque references of the front wheels", torque, "torque_command.drive"
        ),
        "drive_torques": both_front_wheels(
            "Drive torques of the front wheels", torque, "wheel_states.effort"
        ),
        "wheel_speeds": both_front_wheels(
            "Speeds of the front wheels", "wheel speed [rad/s]", "wheel_states.velocity"
        ),
        "dV": one(
            "Difference of linear wheel speeds, right minus left",
            speed,
            lambda run: motion.speed_difference(run, vehicle),
            "dV",
        ),
    }


def _published(key: str) -> list[Curve]:
    """Levels of a panel that fig. 4 prints, or that eqs 4, 5 and 8 to 13 give when steady."""
    slow, fast = paper.SPEED_LEFT_TURN, paper.SPEED_RIGHT_TURN
    left, right = paper.LEFT_TURN, paper.RIGHT_TURN
    first, second = paper.FIRST_ACCELERATION, paper.SECOND_ACCELERATION
    at_slow = (first[1], second[0])
    at_fast = (second[1], END)
    angle = paper.TURN_ANGLE
    torque = paper.differential_torque(paper.hand_torque_assisted(angle), angle)
    levels = {
        "V": [(slow, at_slow), (fast, at_fast)],
        "M": [
            (paper.accelerating_torque(0.0, slow, first[1] - first[0]), first),
            (paper.resisting_torque(slow**2), at_slow),
            (paper.accelerating_torque(slow, fast, second[1] - second[0]), second),
            (paper.resisting_torque(fast**2), at_fast),
        ],
        "delta": [(np.degrees(angle), left), (np.degrees(-angle), right)],
        "dM": [(torque, left), (-torque, right)],
        "wheel_states.velocity": [
            *((each, left) for each in paper.wheel_speeds(slow, angle)),
            *((each, right) for each in paper.wheel_speeds(fast, -angle)),
        ],
        "dV": [
            (paper.speed_difference(slow, angle), left),
            (paper.speed_difference(fast, -angle), right),
        ],
    }
    return [level(value, *window) for value, window in levels.get(key, ())]


def _of_steps(letter: str, *ids: str) -> PublishedPanel:
    needs = (ScenarioNeed("shchur2019_steps"),)
    named = tuple(f"shchur.fig1{letter}.{id}" for id in ids)
    draw = over_time(
        lambda driven: report_steps.panels(driven.runs)[letter],
        report_steps.SINCE_STEP,
        start=0.0,
    )
    return PublishedPanel("1", letter, "Steps of the hand torque", named, needs, draw)


def _of_cycle(quantity: str, *ids: str) -> PublishedPanel:
    needs = (ScenarioNeed("shchur2019"),)
    named = tuple(f"shchur.fig4.{id}" for id in ids)
    draw = over_time(lambda driven: panels(driven.runs, driven.vehicle)[quantity])
    return PublishedPanel("4", quantity, "Driving cycle", named, needs, draw)


PANELS = (
    _of_steps("a", *_STEPS_OF_A, "damped"),
    _of_steps("b", "start", "minimum", "end"),
    scheme("2", "the turn", "shchur.fig2"),
    scheme("3", "the control", "shchur.fig3"),
    _of_cycle("V", "V1", "V2"),
    _of_cycle("M", "M.plateau", "M.acceleration"),
    _of_cycle("delta", "delta.left", "delta.right"),
    _of_cycle("dM", "dM.left", "dM.right"),
    _of_cycle("references", "references"),
    _of_cycle("drive_torques", "drive_torques"),
    _of_cycle("wheel_speeds", "wheel_speeds"),
    _of_cycle("dV", "dV"),
)
