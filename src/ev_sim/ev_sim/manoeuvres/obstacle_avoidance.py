"""Report on the obstacle avoidance of ISO 3888-2: that of the double lane change, on the other course."""

from __future__ import annotations

from ev_core.vehicle.description import Vehicle
from ev_sim.figures.figure import Figure
from ev_sim.manoeuvres.double_lane_change import figures_on, metrics_on
from ev_sim.measures.lane_change_course import OBSTACLE_AVOIDANCE
from ev_sim.measures.metric import Metric
from ev_sim.measures.samples import Runs


def metrics(runs: Runs, vehicle: Vehicle) -> dict[str, Metric]:
    """Cones hit, speed at the entry and largest values between the first and the last cone, for each run."""
    return metrics_on(OBSTACLE_AVOIDANCE, runs, vehicle)


def figures(runs: Runs, vehicle: Vehicle) -> dict[str, Figure]:
    """The course with its cones and the car's path, and the motion over time."""
    return figures_on(OBSTACLE_AVOIDANCE, runs, vehicle)
