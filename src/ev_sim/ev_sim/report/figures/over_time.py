"""Panels over time with a curve for each run; those of the motion of the car by name."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ev_sim.report.figures.panels import Curve, Panel, panel
from ev_sim.report.quantities import motion
from ev_sim.report.samples import Runs, channel
from ev_sim.running.recording.recording import Recording

Quantity = Callable[[Recording], np.ndarray]


def degrees(quantity: Quantity) -> Quantity:
    """An angle [rad] in degrees."""
    return lambda run: np.degrees(quantity(run))


# Title, ordinate and quantity in its unit.
MOTION: dict[str, tuple[str, str, Quantity]] = {
    "steering_wheel_angle": (
        "Steering-wheel angle",
        "angle [deg]",
        degrees(lambda run: channel(run, motion.STEERING_WHEEL_ANGLE)),
    ),
    "yaw_rate": ("Yaw rate", "yaw rate [deg/s]", degrees(lambda run: channel(run, motion.YAW_RATE))),
    "lateral_acceleration": ("Lateral acceleration", "acceleration [m/s²]", motion.lateral_acceleration_on_path),
    "sideslip_angle": ("Sideslip angle", "angle [deg]", degrees(motion.sideslip_angle)),
}


def over_time(
    runs: Runs, title: str, ylabel: str, quantity: Quantity, within: tuple[float, float] | None = None
) -> Panel:
    """A quantity of every run, labelled with the name of the run if there are several."""

    def curves() -> list[Curve]:
        labels = [name.replace("_", " ") if len(runs) > 1 else "" for name in runs]
        return [Curve(run.time, quantity(run), label) for label, run in zip(labels, runs.values(), strict=True)]

    return panel(title, ylabel, curves, within=within)


def motion_panels(runs: Runs, *names: str) -> list[Panel]:
    """Some quantities of MOTION of every run."""
    return [over_time(runs, *MOTION[name]) for name in names]
