"""Report on a launch with different friction left and right: time to speed, slip, deviation."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from ev_core.vehicle.description import Vehicle
from ev_stack.figures.other_axes import plan_view
from ev_stack.figures.panels import Curve, degrees, motion_panels, over_time, panel, readable
from ev_stack.figures.sheets import Sheet
from ev_stack.measures import motion
from ev_stack.measures.metric import LOWER, Metric, NotMeasured, Runs, channel, metric, run_named
from ev_stack.recording.recording import Recording

LAUNCH_SPEED = 5.0  # [m/s], the launch is timed up to it
ROLLING_SPEED = 0.1  # [m/s], above it slip is more than the first turn of a wheel


def split_friction_figures(
    name: str, runs: Runs, vehicle: Vehicle, wheels: Sequence[str]
) -> dict[str, Sheet]:
    """Panels of speed, heading, steering-wheel angle and path of all runs, and of rim speeds.

    The sheet is called `name`, the plan view `path`.
    """

    def rims(name: str) -> list[Curve]:
        run = run_named(runs, name)
        return [
            Curve(run.time, motion.rim_speed(run, vehicle, wheel), readable(wheel))
            for wheel in wheels
        ]

    panels = [
        # Without a sign, which would jump where a car that turns round goes across.
        over_time(
            runs, "Speed over ground", "speed [m/s]", lambda run: np.abs(motion.path_speed(run))
        ),
        over_time(runs, "Heading", "heading [deg]", degrees(motion.heading)),
        *motion_panels(runs, "steering_wheel_angle"),
        *(
            panel(f"Rim speeds, {readable(run)}", "speed [m/s]", lambda run=run: rims(run))
            for run in runs
        ),
    ]
    tracks = [
        Curve(channel(run, "pose.x"), channel(run, "pose.y"), readable(key))
        for key, run in runs.items()
    ]
    return {name: Sheet(panels), "path": plan_view("Path of the centre of mass", tracks)}


def metrics(runs: Runs, vehicle: Vehicle) -> dict[str, Metric]:
    """Time and distance to 5 m/s, deviations by then, slip of the driven wheels, for each run."""

    def of(run: Recording) -> dict[str, Metric]:
        def by_then(values: np.ndarray) -> float:
            return np.abs(values[_launch(run)] - values[_launch(run)][0]).max()

        def way() -> float:
            distance = motion.distance_on_path(run)
            # Between the samples, as the time is: both are those of the same instant.
            return motion.value_at(run, distance, _reached(run)) - distance[_launch(run).start]

        return {
            "time_to_5_m_s": metric(
                lambda: _reached(run) - run.time[_launch(run).start],
                "s",
                "from the first drive torque to 5 m/s",
                LOWER,
            ),
            "distance_to_5_m_s": metric(way, "m", "way of the centre of mass by then", LOWER),
            "peak_yaw_rate": metric(
                lambda: np.abs(channel(run, motion.YAW_RATE)[_launch(run)]).max(),
                "rad/s",
                "max |r| by then",
                LOWER,
            ),
            "peak_yaw_deviation": metric(
                lambda: by_then(motion.heading(run)),
                "rad",
                "max |change of the heading| by then",
                LOWER,
            ),
            "peak_lateral_deviation": metric(
                lambda: by_then(motion.way_aside(run, _launch(run).start)),
                "m",
                "max |way across the first heading| by then",
                LOWER,
            ),
            "peak_steering_wheel_angle": metric(
                lambda: by_then(channel(run, motion.STEERING_WHEEL_ANGLE)),
                "rad",
                "max |change of the steering-wheel angle| by then",
                LOWER,
            ),
            **{
                f"{wheel}_peak_slip": metric(
                    lambda wheel=wheel: _slip(run, wheel),
                    "1",
                    "max |slip ratio| by then, above 0.1 m/s",
                    LOWER,
                )
                for wheel in vehicle.driven_wheels
            },
        }

    return motion.of_each_run(runs, of)


def figures(runs: Runs, vehicle: Vehicle) -> dict[str, Sheet]:
    """Panels of speed, heading, steering-wheel angle and paths of all runs.

    Rim speeds of the first.
    """
    return split_friction_figures("launch", runs, vehicle, vehicle.driven_wheels)


def _launch(run: Recording) -> slice:
    """The samples from the first drive torque to LAUNCH_SPEED."""
    # The sample before the first torque, in which the car still stands or rolls undisturbed.
    start = max(
        motion.first(np.abs(channel(run, motion.DRIVE_TORQUE)) > 0.0, "drive torque") - 1, 0
    )
    end = motion.first(motion.speed(run) >= LAUNCH_SPEED, f"{LAUNCH_SPEED:g} m/s")
    # A run that begins at speed has no launch, and its slice would be empty.
    if end < start:
        raise NotMeasured(f"the car has {LAUNCH_SPEED:g} m/s before it is driven")
    return slice(start, end + 1)


def _reached(run: Recording) -> float:
    """When the car has LAUNCH_SPEED, forwards or in reverse [s]."""
    return motion.crossing_time(run.time, motion.speed(run), LAUNCH_SPEED, f"{LAUNCH_SPEED:g} m/s")


def _slip(run: Recording, wheel: str) -> float:
    part = _launch(run)
    rolling = motion.speed(run)[part] > ROLLING_SPEED
    return np.abs(channel(run, f"tire_forces.slip_ratio.{wheel}")[part][rolling]).max()
