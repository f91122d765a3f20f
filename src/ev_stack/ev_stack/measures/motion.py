"""Motion of the car in the plane from recorded channels, by the standards of vehicle dynamics."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_stack.measures.metric import Metric, NotMeasured, Runs, channel, mean_between
from ev_stack.recording.recording import Recording

ROLL = "imu.roll.orientation_w"  # of cars with a body that rolls
ROLL_RATE = "imu.roll.rate"  # of these as well
ROAD_WHEEL_ANGLE = "steering_column.state.road_wheel_angle"
HAND_TORQUE = "steering_column.state.hand_torque"
DRIVER_HAND_TORQUE = "driver.command.hand_torque"
STEERING_WHEEL_ANGLE = "steering_column.state.angle"
YAW_RATE = "imu.yaw_rate"
LATERAL_ACCELERATION = "imu.lateral_acceleration"
DRIVE_TORQUE = "driver.command.drive_torque"
BRAKE_TORQUE = "driver.command.brake_torque"
SLOWEST = 1.0  # [m/s], below which the direction of travel and slip ratios have little meaning


def right_minus_left(recording: Recording, quantity: str) -> np.ndarray:
    """Difference of the front wheels in a quantity (`wheel_states.effort`), right minus left, (n,)."""
    return channel(recording, f"{quantity}.front_right") - channel(
        recording, f"{quantity}.front_left"
    )


def differential_torque(recording: Recording) -> np.ndarray:
    """Differential torque that the electronic differential commands, (n,) [N m].

    Shchur (2019), eq. 4.
    """
    return right_minus_left(recording, "torque_request.drive")


def path_speed(recording: Recording) -> np.ndarray:
    """Speed of the centre of mass along its path, negative backwards, (n,) [m/s].

    V of Shchur (2019).
    """
    longitudinal = channel(recording, "twist.longitudinal")
    return np.copysign(np.hypot(longitudinal, channel(recording, "twist.lateral")), longitudinal)


def total_drive_torque(recording: Recording) -> np.ndarray:
    """Drive torque that acts at all wheels together, (n,) [N m]."""
    return sum(channel(recording, f"wheel_states.effort.{wheel}") for wheel in WHEEL_NAMES)


def speed_difference(recording: Recording, vehicle: Vehicle) -> np.ndarray:
    """Right minus left linear speed of the front wheels, (n,) [m/s]; Shchur (2019), eq. 12."""
    # Each wheel by its own radius: with unlike tyres equal rim speeds are unlike angular ones.
    left, right, _, _ = vehicle.wheel_radius_ratio
    of_left, of_right = (
        channel(recording, f"wheel_states.velocity.front_{side}") for side in ("left", "right")
    )
    return vehicle.wheel_radius * (right * of_right - left * of_left)


def rim_speed(recording: Recording, vehicle: Vehicle, wheel: str) -> np.ndarray:
    """Speed of the rim of a wheel, its own radius times its angular velocity, (n,) [m/s]."""
    radius = vehicle.wheel_radius * vehicle.wheel_radius_ratio[WHEEL_NAMES.index(wheel)]
    return radius * channel(recording, f"wheel_states.velocity.{wheel}")


def hand_torque_step_time(recording: Recording) -> float:
    """Time at which the driver takes the steering wheel [s]; NotMeasured if that never happens."""
    pushing = np.flatnonzero(channel(recording, DRIVER_HAND_TORQUE))
    if not len(pushing):
        raise NotMeasured("the driver never turns the steering wheel")
    return float(recording.time[pushing[0]])


def mean_while_held(
    recording: Recording, values: np.ndarray, angle: float, start: float, end: float
) -> float:
    """Mean over start <= time < end [s] while the road-wheel angle is held.

    Raises NotMeasured if the angle is not held within 1 deg of `angle` [rad].

    A torque at another angle than the named one would be a different quantity.
    """
    held = mean_between(recording, channel(recording, ROAD_WHEEL_ANGLE), start, end)
    if abs(held - angle) > math.radians(1.0):
        raise NotMeasured(
            f"{math.degrees(held):.2f} deg are held instead of {math.degrees(angle):g} deg"
        )
    return mean_between(recording, values, start, end)


def heading(run: Recording) -> np.ndarray:
    """Heading without jumps, counter-clockwise, (n,) [rad]."""
    return np.unwrap(
        # The quaternion of a rotation about the vertical alone: (cos psi/2, 0, 0, sin psi/2).
        2 * np.arctan2(channel(run, "pose.orientation_z"), channel(run, "pose.orientation_w"))
    )


def roll_angle(run: Recording) -> np.ndarray:
    """Roll angle of the body on its suspension, to the right positive, (n,) [rad]."""
    return 2 * np.arctan2(channel(run, "imu.roll.orientation_x"), channel(run, ROLL))


def speed(run: Recording) -> np.ndarray:
    """Magnitude of the velocity of the centre of mass, (n,) [m/s]."""
    return np.hypot(channel(run, "twist.longitudinal"), channel(run, "twist.lateral"))


def moving(run: Recording) -> np.ndarray:
    """Mark the samples at which the car moves, (n,) bool."""
    return speed(run) >= SLOWEST


def driving_direction(run: Recording) -> np.ndarray:
    """Direction of travel, (n,): 1 from setting off forwards, -1 from setting off in reverse.

    It lasts until the car stands again; at rest it is that of before.

    So a car that slides backwards without having stood still has spun, and does not reverse.
    """
    moves = moving(run)
    # Samples at which the car sets off; one that moves from the start sets off at once.
    begins = np.flatnonzero(moves & ~np.concatenate(([False], moves[:-1])))
    if not len(begins):
        return np.ones(len(moves))
    directions = np.copysign(1.0, channel(run, "twist.longitudinal")[begins])
    # The latest setting off of each sample; those before the first one take its direction.
    which = np.searchsorted(begins, np.arange(len(moves)), side="right") - 1
    return directions[np.maximum(which, 0)]


def sideslip_angle(run: Recording) -> np.ndarray:
    """Angle between the velocity of the centre of mass and the body's axis, (n,) [rad].

    In reverse it counts against the rear of the body.

    Left of the velocity positive forwards (ISO 8855), and on a circle of one steering angle the
    same in reverse.
    """
    direction = driving_direction(run)
    # + 0.0 makes 0 of -0: at rest in reverse arctan2(-0, -0) would be -pi.
    along, across = (
        direction * channel(run, f"twist.{name}") + 0.0 for name in ("longitudinal", "lateral")
    )
    return np.arctan2(across, along)


def sideslip_in_motion(run: Recording, continuous: bool = False) -> np.ndarray:
    """Sideslip angle where the car moves, (n,) [rad].

    NaN at rest, where a velocity of rounding errors has any direction.

    A `continuous` one goes on beyond half a turn.
    """
    # Before the NaN at rest: unwrap would carry one to all samples behind it.
    angle = np.unwrap(sideslip_angle(run)) if continuous else sideslip_angle(run)
    return np.where(moving(run), angle, np.nan)


def lateral_acceleration_on_path(run: Recording) -> np.ndarray:
    """Acceleration of the centre of mass across its path, level, left positive, (n,) [m/s^2].

    The centripetal acceleration of ISO 8855.
    """
    sideslip = sideslip_angle(run)
    along, across = (
        channel(run, "imu.longitudinal_acceleration"),
        channel(run, LATERAL_ACCELERATION),
    )
    # The part of the acceleration that is normal to the velocity; the rest changes the speed.
    return across * np.cos(sideslip) - along * np.sin(sideslip)


def radius_of_path(run: Recording) -> np.ndarray:
    """Radius of curvature of the path of the centre of mass, left positive, (n,) [m].

    V/(w + beta') of Ge & Ni (2005).

    Infinite where the path is straight.
    """
    with np.errstate(divide="ignore"):
        return speed(run) ** 2 / lateral_acceleration_on_path(run)


def distance_on_path(run: Recording) -> np.ndarray:
    """Distance that the centre of mass has travelled, (n,) [m]."""
    steps = np.hypot(np.diff(channel(run, "pose.x")), np.diff(channel(run, "pose.y")))
    return np.concatenate(([0.0], np.cumsum(steps)))


def way_aside(run: Recording, begin: int = 0) -> np.ndarray:
    """Way of the centre of mass across the straight on from an instant, left positive, (n,) [m]."""
    x, y, angle = channel(run, "pose.x"), channel(run, "pose.y"), heading(run)[begin]
    return (y - y[begin]) * np.cos(angle) - (x - x[begin]) * np.sin(angle)


def first(condition: np.ndarray, what: str) -> int:
    """Index of the first sample at which the condition holds; NotMeasured if there is none."""
    found = np.flatnonzero(condition)
    if not len(found):
        raise NotMeasured(f"{what} never comes")
    return int(found[0])


def crossing_time(time: np.ndarray, values: np.ndarray, level: float, what: str) -> float:
    """Time at which the values first reach a level from below, linear between samples [s].

    Raises NotMeasured if they never do.

    Nor is it known of values that are beyond the level from the first sample on.
    """
    n = first(values >= level, what)
    # Without a sample below the level there is nothing to interpolate from.
    if n == 0:
        if values[0] > level:
            raise NotMeasured(f"{what} was passed before {time[0]:g} s")
        return float(time[0])
    before, after = values[n - 1], values[n]
    return float(time[n - 1] + (level - before) / (after - before) * (time[n] - time[n - 1]))


def value_at(run: Recording, values: np.ndarray, time: float) -> float:
    """Value at a time [s], linear between samples; NotMeasured if the run does not have it."""
    # Rounding of an instant must not make the last sample one that is missing.
    if not run.time[0] <= time <= run.time[-1] + 1e-9:
        ends = f"{run.time[0]:g} s to {run.time[-1]:g} s"
        raise NotMeasured(f"the run lasts from {ends}, without {time:g} s")
    return float(np.interp(time, run.time, values))


def of_each_run(runs: Runs, measure: Callable[[Recording], dict[str, Metric]]) -> dict[str, Metric]:
    """The metrics of every run; the name of the run stands in front if there are several."""
    return {
        f"{name}_{key}" if len(runs) > 1 else key: value
        for name, run in runs.items()
        for key, value in measure(run).items()
    }


def line_over(
    across: np.ndarray, values: np.ndarray, low: float, high: float
) -> tuple[float, float]:
    """Slope and offset, by least squares, of values (n,) over a lateral acceleration (n,).

    Samples within bounds of the acceleration [m/s^2] count.

    It is that before the acceleration is first above them; NotMeasured if it never is, or jumps
    over them.
    """
    # Only up to there: on its way back the car may have lost the steady state.
    end = first(across > high, f"a lateral acceleration of {high:.2f} m/s^2")
    inside = across[:end] >= low
    if np.count_nonzero(inside) < 2:
        raise NotMeasured(f"the lateral acceleration jumps over {low:.2f} to {high:.2f} m/s^2")
    slope, offset = np.polyfit(across[:end][inside], values[:end][inside], 1)
    return float(slope), float(offset)
