"""Report on braking on split friction: stopping distance, deviation, locked wheels (ISO 14512)."""

from __future__ import annotations

import numpy as np

from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_stack.figures.sheets import Sheet
from ev_stack.manoeuvres.launch_split_mu import split_friction_figures
from ev_stack.measures import motion
from ev_stack.measures.metric import HIGHER, LOWER, Metric, Runs, channel, metric
from ev_stack.recording.recording import Recording

STANDING = 0.1  # [m/s], the car counts as stopped
LOCKED_SPEED = 2.0  # [m/s], below it every braked wheel is about to stand
LOCKED_SLIP = -0.95  # a wheel with this slip ratio counts as locked
ONE_SECOND = 1.0  # after the onset of braking, where ISO 14512 reads the deviation


def metrics(runs: Runs) -> dict[str, Metric]:
    """Stopping distance and time, deviations and times of locked wheels, for each run."""

    def initial_speed(run: Recording) -> float:
        return motion.path_speed(run)[_onset(run)]

    def stopping_distance(run: Recording) -> float:
        return np.ptp(motion.distance_on_path(run)[_braking(run)])

    def of(run: Recording) -> dict[str, Metric]:
        return {
            "initial_speed": metric(lambda: initial_speed(run), "m/s", "V at the onset of braking"),
            "stopping_distance": metric(
                lambda: stopping_distance(run),
                "m",
                "way from the onset of braking to 0.1 m/s",
                LOWER,
            ),
            "mean_deceleration": metric(
                lambda: initial_speed(run) ** 2 / (2 * stopping_distance(run)),
                "m/s^2",
                "V^2/(2 stopping distance)",
                HIGHER,
            ),
            "yaw_rate_after_1_s": metric(
                lambda: _after_a_second(run, channel(run, motion.YAW_RATE)),
                "rad/s",
                "r 1 s after the onset (ISO 14512)",
            ),
            "peak_yaw_rate": metric(
                lambda: np.abs(channel(run, motion.YAW_RATE)[_braking(run)]).max(),
                "rad/s",
                "max |r| until the stop",
                LOWER,
            ),
            "yaw_deviation_after_1_s": metric(
                lambda: _after_a_second(run, motion.heading(run)),
                "rad",
                "change of the heading in 1 s (ISO 14512)",
            ),
            "peak_yaw_deviation": metric(
                lambda: _largest_deviation(run, motion.heading(run)),
                "rad",
                "max |change of the heading| until the stop",
                LOWER,
            ),
            "peak_lateral_deviation": metric(
                lambda: _largest_deviation(run, motion.way_aside(run, _onset(run))),
                "m",
                "max |way across the heading at the onset|",
                LOWER,
            ),
            "peak_steering_wheel_angle": metric(
                lambda: np.abs(channel(run, motion.STEERING_WHEEL_ANGLE)[_braking(run)]).max(),
                "rad",
                "largest magnitude until the stop",
                LOWER,
            ),
            **{
                f"{wheel}_locked": metric(
                    lambda wheel=wheel: _locked(run, wheel),
                    "%",
                    "share of the time above 2 m/s with a slip ratio below -0.95",
                    LOWER,
                )
                for wheel in WHEEL_NAMES
            },
        }

    return motion.of_each_run(runs, of)


def figures(runs: Runs, vehicle: Vehicle) -> dict[str, Sheet]:
    """Speed, heading, steering-wheel angle and path of all runs, and the wheels of each."""
    return split_friction_figures("braking", runs, vehicle, WHEEL_NAMES)


def _onset(run: Recording) -> int:
    """Index of the last sample before there is brake torque."""
    return max(motion.first(channel(run, motion.BRAKE_TORQUE) > 0.0, "braking") - 1, 0)


def _braking(run: Recording) -> slice:
    """The samples from the onset of braking to the stop."""
    start = _onset(run)
    return slice(
        start,
        start + motion.first(np.abs(motion.path_speed(run)[start:]) < STANDING, "the stop") + 1,
    )


def _after_a_second(run: Recording, values: np.ndarray) -> float:
    start = _onset(run)
    # As a change since the onset, so a yaw rate or heading of before does not count.
    return motion.value_at(run, values - values[start], float(run.time[start]) + ONE_SECOND)


def _largest_deviation(run: Recording, values: np.ndarray) -> float:
    part = values[_braking(run)]
    return np.abs(part - part[0]).max()


def _locked(run: Recording, wheel: str) -> float:
    """Share of the braking time above LOCKED_SPEED during which a wheel is locked [%]."""
    part = _braking(run)
    fast = np.abs(motion.path_speed(run)[part]) > LOCKED_SPEED
    # in reverse a braked wheel slips forwards
    towards = np.copysign(1.0, motion.path_speed(run)[part])
    locked = towards * channel(run, f"tire_forces.slip_ratio.{wheel}")[part] < LOCKED_SLIP
    # A stop from below 2 m/s has no sample that counts, and no locked wheel.
    return 100 * np.count_nonzero(locked & fast) / max(np.count_nonzero(fast), 1)
