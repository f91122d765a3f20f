"""Report on the driving cycle of Shchur (2019): fig. 4, one run of 50 s with a left and a right turn.

The right turn (30 deg at 30 km/h) would need a lateral acceleration of about 1.6 g: the kinematic plant reproduces
it as the paper computes it, a plant with tyres does not.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from ev_msgs_py.vehicle.description import Vehicle
from ev_sim.report.figures.panels import Curve, Panel, panel
from ev_sim.report.metric import Metric, Reference, metric, within
from ev_sim.report.papers import shchur2019 as paper
from ev_sim.report.papers import shchur2019_references as references
from ev_sim.report.quantities import derived
from ev_sim.report.samples import Parameters, Runs, channel, mean_between, run_named
from ev_sim.run.recording.recording import Recording

if TYPE_CHECKING:
    from matplotlib.figure import Figure

RUN = "shchur2019"
LEFT = (paper.LEFT_TURN[1] - 1.0, paper.LEFT_TURN[1])  # last second of the turn [s]
RIGHT = (paper.RIGHT_TURN[1] - 1.0, paper.RIGHT_TURN[1])


def metrics(runs: Runs, vehicle: Vehicle, parameters: Parameters) -> dict[str, Metric]:
    """Steering angle and wheel speeds in both turns, hand torque and differential torque in the left turn."""

    def speed_difference(window: tuple[float, float]) -> float:
        run = run_named(runs, RUN)
        return mean_between(run, derived.speed_difference(run, vehicle), *window)

    def steering_angle(window: tuple[float, float]) -> float:
        run = run_named(runs, RUN)
        return mean_between(run, channel(run, derived.ROAD_WHEEL_ANGLE), *window)

    def hand_torque() -> float:
        run = run_named(runs, RUN)
        return derived.mean_while_held(run, channel(run, derived.HAND_TORQUE), paper.TURN_ANGLE, *LEFT)

    def differential_torque() -> float:
        run = run_named(runs, RUN)
        return derived.mean_while_held(run, derived.differential_torque(run), paper.TURN_ANGLE, *LEFT)

    return {
        "speed_difference_left_turn": metric(
            lambda: speed_difference(LEFT),
            "m/s",
            _speed_reference(paper.SPEED_LEFT_TURN, paper.TURN_ANGLE, parameters),
        ),
        "speed_difference_right_turn": metric(
            lambda: speed_difference(RIGHT),
            "m/s",
            _speed_reference(paper.SPEED_RIGHT_TURN, -paper.TURN_ANGLE, parameters),
        ),
        "steering_angle_left_turn": metric(
            lambda: steering_angle(LEFT), "rad", _angle_reference(paper.TURN_ANGLE, parameters)
        ),
        "steering_angle_right_turn": metric(
            lambda: steering_angle(RIGHT), "rad", _angle_reference(-paper.TURN_ANGLE, parameters)
        ),
        "hand_torque_30deg_assisted": metric(hand_torque, "N m", references.hand_torque_assisted()),
        "differential_torque_30deg": metric(differential_torque, "N m", references.differential_torque()),
    }


def _angle_reference(angle: float, parameters: Parameters) -> Reference:
    source = f"printed: delta = {math.degrees(angle):g} deg (description of fig. 4)"
    return Reference(angle, references.angle_band(angle, parameters), source)


def _speed_reference(speed: float, angle: float, parameters: Parameters) -> Reference:
    value = paper.speed_difference(speed, angle)
    band = within(value, relative=references.WHEEL_SPEEDS)
    assumptions = []
    right_turn = angle < 0
    if right_turn:
        assumptions.append("sign of delta in eq. 11 (printed without)")
    if right_turn and not references.ideal(parameters):
        assumptions.append("bus voltage (not printed; the EMF is highest here)")
    if references.switched(parameters):
        off = references.SWITCHED_ANGLE
        low, high = sorted((paper.speed_difference(speed, angle - off), paper.speed_difference(speed, angle + off)))
        band = low, high
        assumptions.append("switched drives: band of eq. 12 for a steering angle within 4 deg")
    return Reference(value, band, references.follows("eqs. 8 to 12"), "; ".join(assumptions))


def figures(runs: Runs, vehicle: Vehicle) -> dict[str, Figure]:
    """Fig. 4 as one sheet, with the panels of the paper."""
    from ev_sim.report.figures.drawing import sheet

    def panel_of(title: str, ylabel: str, values: Callable[[Recording], np.ndarray]) -> Panel:
        return panel(title, ylabel, lambda: [Curve(run_named(runs, RUN).time, values(run_named(runs, RUN)))])

    def panel_of_both(title: str, ylabel: str, quantity: str) -> Panel:
        def curves() -> list[Curve]:
            run = run_named(runs, RUN)
            return [Curve(run.time, channel(run, f"{quantity}.front_{side}"), side) for side in ("right", "left")]

        return panel(title, ylabel, curves)

    panels = [
        panel_of("a  Speed", "speed [km/h]", lambda run: 3.6 * derived.speed(run)),
        panel_of("b  Total torque at the wheels", "torque [N m]", derived.total_drive_torque),
        panel_of("c  Steering angle", "angle [deg]", lambda run: np.degrees(channel(run, derived.ROAD_WHEEL_ANGLE))),
        panel_of("d  Differential torque, right minus left", "torque [N m]", derived.differential_torque),
        panel_of_both("e  Torque references of the front wheels", "torque [N m]", "torque_command.drive"),
        panel_of_both("f  Drive torques of the front wheels", "torque [N m]", "wheel_states.effort"),
        panel_of_both("g  Speeds of the front wheels", "speed [rad/s]", "wheel_states.velocity"),
        panel_of(
            "h  Difference of linear wheel speeds, right minus left",
            "speed [m/s]",
            lambda run: derived.speed_difference(run, vehicle),
        ),
    ]
    return {"fig4": sheet(panels, "time [s]")}
