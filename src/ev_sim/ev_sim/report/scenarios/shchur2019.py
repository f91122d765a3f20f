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


def panels(runs: Runs, vehicle: Vehicle) -> dict[str, Panel]:
    """The panels of fig. 4 by their quantity, in the order of the paper."""

    def panel_of(title: str, ylabel: str, values: Callable[[Recording], np.ndarray]) -> Panel:
        return panel(title, ylabel, lambda: [Curve(run_named(runs, RUN).time, values(run_named(runs, RUN)))])

    def panel_of_both(title: str, ylabel: str, quantity: str) -> Panel:
        def curves() -> list[Curve]:
            run = run_named(runs, RUN)
            return [Curve(run.time, channel(run, f"{quantity}.front_{side}"), side) for side in ("right", "left")]

        return panel(title, ylabel, curves)

    return {
        "V": panel_of("Speed", "speed [km/h]", lambda run: 3.6 * derived.speed(run)),
        "M": panel_of("Total torque at the wheels", "torque [N m]", derived.total_drive_torque),
        "delta": panel_of(
            "Steering angle", "angle [deg]", lambda run: np.degrees(channel(run, derived.ROAD_WHEEL_ANGLE))
        ),
        "dM": panel_of("Differential torque, right minus left", "torque [N m]", derived.differential_torque),
        "references": panel_of_both("Torque references of the front wheels", "torque [N m]", "torque_command.drive"),
        "drive_torques": panel_of_both("Drive torques of the front wheels", "torque [N m]", "wheel_states.effort"),
        "wheel_speeds": panel_of_both("Speeds of the front wheels", "speed [rad/s]", "wheel_states.velocity"),
        "dV": panel_of(
            "Difference of linear wheel speeds, right minus left",
            "speed [m/s]",
            lambda run: derived.speed_difference(run, vehicle),
        ),
    }


def figures(runs: Runs, vehicle: Vehicle) -> dict[str, Figure]:
    """Fig. 4 as one sheet, with the panels of the paper."""
    from ev_sim.report.figures.drawing import sheet

    return {"fig4": sheet(list(panels(runs, vehicle).values()), "time [s]")}
