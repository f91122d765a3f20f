"""Figures of a car on split friction that pulls away or brakes: how it moves, how its wheels turn, where it goes."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ev_core.vehicle.description import Vehicle
from ev_sim.figures.drawing import Curve, Figure, degrees, motion_panels, over_time, panel, sheet
from ev_sim.figures.other_axes import plan_view
from ev_sim.measures import motion
from ev_sim.measures.metric import Runs, channel, run_named


def split_friction_figures(name: str, runs: Runs, vehicle: Vehicle, wheels: Sequence[str]) -> dict[str, Figure]:
    """Speed, heading, steering-wheel angle and path of all runs, and the rim speeds of some wheels of each.

    The sheet is called `name`, the plan view `path`.
    """

    def rims(name: str) -> list[Curve]:
        run, radius = run_named(runs, name), vehicle.wheel_radius
        turning = ((wheel, radius * channel(run, f"wheel_states.velocity.{wheel}")) for wheel in wheels)
        return [Curve(run.time, speed, wheel.replace("_", " ")) for wheel, speed in turning]

    panels = [
        # Without a sign, which would jump where a car that turns round goes across.
        over_time(runs, "Speed over ground", "speed [m/s]", lambda run: np.abs(motion.path_speed(run))),
        over_time(runs, "Heading", "heading [deg]", degrees(motion.heading)),
        *motion_panels(runs, "steering_wheel_angle"),
        *(panel(f"Rim speeds, {run.replace('_', ' ')}", "speed [m/s]", lambda run=run: rims(run)) for run in runs),
    ]
    tracks = [Curve(channel(run, "pose.x"), channel(run, "pose.y"), key.replace("_", " ")) for key, run in runs.items()]
    return {name: sheet(panels, "time [s]"), "path": plan_view("Path of the centre of mass", tracks)}
