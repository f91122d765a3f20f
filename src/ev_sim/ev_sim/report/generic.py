"""Report on any scenario: speed, torques, steering angle and wheel speeds of each run."""

from __future__ import annotations

import numpy as np

from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_sim.figures.drawing import sheet
from ev_sim.figures.figure import Figure
from ev_sim.figures.panels import Curve, Panel, panel
from ev_sim.measures import can_bus, motion
from ev_sim.measures.metric import Metric, metric
from ev_sim.measures.samples import Runs, channel
from ev_sim.recording.recording import Recording


def metrics(runs: Runs) -> dict[str, Metric]:
    """Speeds and largest torque and angle of each run; the name of the run stands in front if there are several."""
    return motion.of_each_run(runs, _metrics)


def figures(runs: Runs) -> dict[str, Figure]:
    """One sheet for each run."""
    return {
        f"overview_{name}" if len(runs) > 1 else "overview": sheet(_panels(run), "time [s]")
        for name, run in runs.items()
    }


def _metrics(run: Recording) -> dict[str, Metric]:
    return {
        "final_speed": metric(lambda: motion.path_speed(run)[-1], "m/s"),
        "maximum_speed": metric(lambda: motion.speed(run).max(), "m/s"),
        "maximum_total_drive_torque": metric(lambda: np.abs(motion.total_drive_torque(run)).max(), "N m"),
        "maximum_road_wheel_angle": metric(lambda: np.abs(channel(run, motion.ROAD_WHEEL_ANGLE)).max(), "rad"),
        **can_bus.metrics(run),
    }


def _panels(run: Recording) -> list[Panel]:
    def wheels(quantity: str) -> list[Curve]:
        return [Curve(run.time, channel(run, f"{quantity}.{name}"), name.replace("_", " ")) for name in WHEEL_NAMES]

    def steering_angle() -> list[Curve]:
        return [Curve(run.time, np.degrees(channel(run, motion.ROAD_WHEEL_ANGLE)))]

    return [
        panel("Speed", "speed [m/s]", lambda: [Curve(run.time, motion.path_speed(run))]),
        panel("Steering angle", "angle [deg]", steering_angle),
        panel("Drive torques", "torque [N m]", lambda: wheels("wheel_states.effort")),
        panel("Wheel speeds", "speed [rad/s]", lambda: wheels("wheel_states.velocity")),
    ]
