"""Shchur (2019), with the report of his driving cycle: fig. 4, one run of 50 s with a left and a right turn.

The right turn (30 deg at 30 km/h) would need a lateral acceleration of about 1.6 g: the kinematic plant reproduces
it as the paper computes it, a plant with tyres does not.

A source has its place ORDER, the functions MEASURES that measure the numbers of published.csv, and its PANELS.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ev_core.vehicle.description import Vehicle
from ev_papers.shchur2019 import measures, paper, report_steps
from ev_sim.figures.panels import Curve, Panel, degrees, level, panel
from ev_sim.figures.sheets import Sheet
from ev_sim.measures import motion
from ev_sim.measures.metric import Metric, Parameters, Runs, channel, run_named
from ev_sim.recording.recording import Recording
from ev_study.verdicts.measure import measures_of
from ev_study.verdicts.need import ScenarioNeed, ScenarioRuns
from ev_study.verdicts.panels_page import PublishedPanel, cannot_be_drawn, over_time
from ev_study.verdicts.verdict import metrics_at_hand

RUN = "shchur2019"
END = 50.0  # of the cycle [s]


def metrics(runs: Runs, vehicle: Vehicle, parameters: Parameters) -> dict[str, Metric]:
    """What fig. 4 is judged by."""
    return metrics_at_hand("shchur2019", RUN, ScenarioRuns(runs, vehicle, parameters))


def panels(runs: Runs, vehicle: Vehicle) -> dict[str, Panel]:
    """The panels of fig. 4 by their quantity, in the order of the paper, with what it prints or what follows."""
    published = _published()

    def panel_of(title: str, ylabel: str, values: Callable[[Recording], np.ndarray], name: str = "") -> Panel:
        def curves() -> list[Curve]:
            run = run_named(runs, RUN)
            return [Curve(run.time, values(run), "ours" if name else ""), *published.get(name, ())]

        return panel(title, ylabel, curves)

    def panel_of_both(title: str, ylabel: str, quantity: str) -> Panel:
        def curves() -> list[Curve]:
            run = run_named(runs, RUN)
            ours = [Curve(run.time, channel(run, f"{quantity}.front_{side}"), side) for side in ("right", "left")]
            return [*ours, *published.get(quantity, ())]

        return panel(title, ylabel, curves)

    return {
        "V": panel_of("Speed", "speed [m/s]", motion.path_speed, "V"),
        "M": panel_of("Total torque at the wheels", "torque [N m]", motion.total_drive_torque, "M"),
        "delta": panel_of(
            "Steering angle", "angle [deg]", degrees(lambda run: channel(run, motion.ROAD_WHEEL_ANGLE)), "delta"
        ),
        "dM": panel_of("Differential torque, right minus left", "torque [N m]", motion.differential_torque, "dM"),
        "references": panel_of_both("Torque references of the front wheels", "torque [N m]", "torque_command.drive"),
        "drive_torques": panel_of_both("Drive torques of the front wheels", "torque [N m]", "wheel_states.effort"),
        "wheel_speeds": panel_of_both("Speeds of the front wheels", "wheel speed [rad/s]", "wheel_states.velocity"),
        "dV": panel_of(
            "Difference of linear wheel speeds, right minus left",
            "speed [m/s]",
            lambda run: motion.speed_difference(run, vehicle),
            "dV",
        ),
    }


def _published() -> dict[str, list[Curve]]:
    """What fig. 4 prints and what eqs 4, 5 and 8 to 13 give with the printed parameters, where it is steady."""
    slow, fast = paper.SPEED_LEFT_TURN, paper.SPEED_RIGHT_TURN
    left, right = paper.LEFT_TURN, paper.RIGHT_TURN
    first, second = paper.FIRST_ACCELERATION, paper.SECOND_ACCELERATION
    at_slow, at_fast = (first[1], second[0]), (second[1], END)
    torque = paper.differential_torque(paper.hand_torque_assisted(paper.TURN_ANGLE), paper.TURN_ANGLE)
    turns = ((slow, paper.TURN_ANGLE, left), (fast, -paper.TURN_ANGLE, right))
    return {
        "V": [level(slow, *at_slow), level(fast, *at_fast)],
        "M": [
            level(paper.accelerating_torque(0.0, slow, first[1] - first[0]), *first),
            level(paper.resisting_torque(slow**2), *at_slow),
            level(paper.accelerating_torque(slow, fast, second[1] - second[0]), *second),
            level(paper.resisting_torque(fast**2), *at_fast),
        ],
        "delta": [level(np.degrees(angle), *window) for _, angle, window in turns],
        "dM": [level(torque, *left), level(-torque, *right)],
        "wheel_states.velocity": [
            level(each, *window) for speed, angle, window in turns for each in paper.wheel_speeds(speed, angle)
        ],
        "dV": [level(paper.speed_difference(speed, angle), *window) for speed, angle, window in turns],
    }


def figures(runs: Runs, vehicle: Vehicle) -> dict[str, Sheet]:
    """Fig. 4 as one sheet, with the panels of the paper."""
    return {"fig4": Sheet(list(panels(runs, vehicle).values()))}


ORDER = 0  # among the sources, in tables
MEASURES = measures_of(measures)


def _of_steps(letter: str, *ids: str) -> PublishedPanel:
    draw = over_time(lambda driven: report_steps.panels(driven.runs)[letter], report_steps.SINCE_STEP, start=0.0)
    named = tuple(f"shchur.fig1{letter}.{id}" for id in ids)
    return PublishedPanel("1", letter, "Steps of the hand torque", named, (ScenarioNeed("shchur2019_steps"),), draw)


def _of_cycle(quantity: str, *ids: str) -> PublishedPanel:
    draw = over_time(lambda driven: panels(driven.runs, driven.vehicle)[quantity])
    named = tuple(f"shchur.fig4.{id}" for id in ids)
    return PublishedPanel("4", quantity, "Driving cycle", named, (ScenarioNeed("shchur2019"),), draw)


PANELS = (
    _of_steps("a", "1.steady", "1.overshoot", "1.settling", "2.steady", "2.overshoot", "2.settling", "damped"),
    _of_steps("b", "start", "minimum", "end"),
    cannot_be_drawn("2", "", "Schemes", "a scheme of the turn, no quantity over another one", "shchur.fig2"),
    cannot_be_drawn("3", "", "Schemes", "a scheme of the control, no quantity over another one", "shchur.fig3"),
    _of_cycle("V", "V1", "V2"),
    _of_cycle("M", "M.plateau", "M.acceleration"),
    _of_cycle("delta", "delta.left", "delta.right"),
    _of_cycle("dM", "dM.left", "dM.right"),
    _of_cycle("references", "references"),
    _of_cycle("drive_torques", "drive_torques"),
    _of_cycle("wheel_speeds", "wheel_speeds"),
    _of_cycle("dV", "dV"),
)
