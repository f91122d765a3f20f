"""Report on the driving cycle of Shchur (2019): fig. 4, one run of 50 s with a left and a right turn.

The right turn (30 deg at 30 km/h) would need a lateral acceleration of about 1.6 g: the kinematic plant reproduces
it as the paper computes it, a plant with tyres does not.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from ev_msgs_py.vehicle.description import Vehicle
from ev_sim.report.figures.panels import Curve, Panel, panel
from ev_sim.report.metric import Metric
from ev_sim.report.quantities import derived
from ev_sim.report.samples import Parameters, Runs, channel, run_named
from ev_sim.run.recording.recording import Recording
from ev_sim.verdicts.all_verdicts import metrics_at_hand
from ev_sim.verdicts.need import ScenarioRuns

if TYPE_CHECKING:
    from matplotlib.figure import Figure

RUN = "shchur2019"


def metrics(runs: Runs, vehicle: Vehicle, parameters: Parameters) -> dict[str, Metric]:
    """What fig. 4 is judged by."""
    return metrics_at_hand("shchur2019", RUN, ScenarioRuns(runs, vehicle, parameters))


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
