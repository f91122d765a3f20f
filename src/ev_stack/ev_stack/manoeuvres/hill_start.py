"""Report on a hill start: standing while held, roll-back, and spin of the driven wheels."""

from __future__ import annotations

import numpy as np

from ev_core.vehicle.description import Vehicle
from ev_stack.figures.panels import Curve, motion_panels, over_time, panel, readable
from ev_stack.figures.sheets import Sheet
from ev_stack.measures import motion
from ev_stack.measures.metric import LOWER, Metric, NotMeasured, Runs, channel, metric
from ev_stack.recording.recording import Recording

# [m/s], above it the car has pulled away and slip is more than the first turn of a wheel
ROLLING_SPEED = 0.1
PULL_AWAY = 1.0  # [m], the pull-away is timed over it


def metrics(runs: Runs, vehicle: Vehicle) -> dict[str, Metric]:
    """Movement under the brake, roll-back, slip, and time for the first metre, of each run."""

    def of(run: Recording) -> dict[str, Metric]:
        def moved() -> float:
            x, y = channel(run, "pose.x"), channel(run, "pose.y")
            return np.hypot(x - x[0], y - y[0])[: _release(run) + 1].max()

        def first_metre() -> float:
            start = run.time[_release(run)]
            return motion.crossing_time(
                run.time, _uphill(run), PULL_AWAY, "the first metre"
            ) - float(start)

        def sign_changes() -> float:
            return float(np.count_nonzero(np.diff(np.sign(_slips(run, vehicle)), axis=-1)))

        return {
            "holding_time": metric(
                lambda: run.time[_release(run)] - run.time[0],
                "s",
                "from the start to the first release of the brake",
            ),
            "movement_while_holding": metric(
                moved, "m", "largest distance from the start until then", LOWER
            ),
            "roll_back": metric(
                lambda: max(0.0, float(-_uphill(run)[_release(run) :].min())),
                "m",
                "largest way against the drive torque after the release",
                LOWER,
            ),
            "time_for_one_metre": metric(
                first_metre,
                "s",
                "from the release to 1 m in the direction of the drive torque",
                LOWER,
            ),
            "pull_away_peak_slip": metric(
                lambda: np.abs(_slips(run, vehicle)).max(),
                "1",
                "max |slip ratio| of the driven wheels from 0.1 m/s on",
                LOWER,
            ),
            "slip_sign_changes": metric(
                sign_changes, "1", "changes of the sign of their slip ratios", LOWER
            ),
        }

    return motion.of_each_run(runs, of)


def figures(runs: Runs, vehicle: Vehicle) -> dict[str, Sheet]:
    """Pedals, travelled distance, speed and slip around the pull-away."""

    def pedals() -> list[Curve]:
        run = next(iter(runs.values()))
        return [
            Curve(run.time, channel(run, motion.DRIVE_TORQUE), "drive"),
            Curve(run.time, channel(run, motion.BRAKE_TORQUE), "brake"),
        ]

    driven = vehicle.driven_wheels[0]
    panels = [
        panel("Pedals of the first run", "torque [N m]", pedals),
        over_time(runs, "Way uphill", "distance [m]", _uphill),
        *motion_panels(runs, "speed"),
        over_time(
            runs,
            f"Slip ratio, {readable(driven)}",
            "slip ratio [1]",
            lambda run: channel(run, f"tire_forces.slip_ratio.{driven}"),
        ),
    ]
    return {"pull_away": Sheet(panels, start=_pull_away(runs))}


def _pull_away(runs: Runs) -> float | None:
    """A second before the first release of the brake [s]; None if there is none."""
    try:
        return min(float(run.time[_release(run)]) for run in runs.values()) - 1.0
    except NotMeasured:
        return None


def _release(run: Recording) -> int:
    """Index of the last sample before the driver begins to release the brake."""
    brake = channel(run, motion.BRAKE_TORQUE)
    return max(motion.first(np.diff(brake) < 0.0, "the release of the brake"), 0)


def _uphill(run: Recording) -> np.ndarray:
    """Distance from the start in the direction of the drive torque, (n,) [m]."""
    drive = channel(run, motion.DRIVE_TORQUE)
    # By the largest torque: for a start in reverse the car stands with its tail uphill.
    direction = np.sign(drive[np.abs(drive).argmax()])
    if direction == 0.0:
        raise NotMeasured("there is no drive torque")
    # Along the first heading, not the path: rolling back has to take from the way, not add to it.
    heading = motion.heading(run)[0]
    x, y = channel(run, "pose.x"), channel(run, "pose.y")
    return direction * ((x - x[0]) * np.cos(heading) + (y - y[0]) * np.sin(heading))


def _slips(run: Recording, vehicle: Vehicle) -> np.ndarray:
    """Slip ratios of the driven wheels from the pull-away on, (wheels, n) [1]."""
    start = _release(run)
    # While brake and drive hold each other the wheels stand, and their slip ratio means little.
    start += motion.first(channel(run, motion.BRAKE_TORQUE)[start:] == 0.0, "the end of braking")
    start += motion.first(np.abs(motion.path_speed(run)[start:]) > ROLLING_SPEED, "the pull-away")
    return np.array(
        [channel(run, f"tire_forces.slip_ratio.{wheel}")[start:] for wheel in vehicle.driven_wheels]
    )
