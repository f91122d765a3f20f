"""Which report a scenario gets."""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Protocol

from ev_msgs_py.vehicle.description import Vehicle
from ev_sim.report.metric import Metric
from ev_sim.report.samples import Parameters, Runs

if TYPE_CHECKING:
    from matplotlib.figure import Figure

REPORTS = {
    "coast_down": "ev_sim.report.scenarios.coast_down",
    "double_lane_change": "ev_sim.report.scenarios.double_lane_change",
    "ge_ni2005": "ev_sim.report.scenarios.ge_ni2005",
    "hill_start": "ev_sim.report.scenarios.hill_start",
    "launch_split_mu": "ev_sim.report.scenarios.launch_split_mu",
    "shchur2019": "ev_sim.report.scenarios.shchur2019",
    "shchur2019_steps": "ev_sim.report.scenarios.shchur2019_steps",
    "sine_with_dwell": "ev_sim.report.scenarios.sine_with_dwell",
    "steady_circle": "ev_sim.report.scenarios.steady_circle",
    "step_steer": "ev_sim.report.scenarios.step_steer",
    "straight_brake_split_mu": "ev_sim.report.scenarios.straight_brake_split_mu",
    "tatar_chudzik": "ev_sim.report.scenarios.tatar_chudzik",
    "urban_mixed": "ev_sim.report.scenarios.urban_mixed",
    "zhileykin2018": "ev_sim.report.scenarios.zhileykin2018",
}
GENERIC = "ev_sim.report.generic"


class Report(Protocol):
    """A module that makes numbers and figures of the runs of a scenario."""

    def metrics(self, runs: Runs, vehicle: Vehicle, parameters: Parameters) -> dict[str, Metric]:
        """Metrics by name, in the order of the table."""

    def figures(self, runs: Runs, vehicle: Vehicle, parameters: Parameters) -> dict[str, Figure]:
        """Figures by the name of their file without suffix."""


def report_for(scenario: str) -> Report:
    """The report of a scenario, or the generic one if it has none of its own."""
    return import_module(REPORTS.get(scenario, GENERIC))
