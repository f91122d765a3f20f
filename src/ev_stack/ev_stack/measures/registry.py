"""Metrics of any run by name, with unit, formula, channels that it needs, and the better direction.

A metric is a pure function of a driven run. An entry in _OF_ANY_RUN is all that a new one takes:
runs, comparisons, sweeps, batches, the files of scenarios and docs/metrics.md know it then. Another
package offers its own by an entry point.
"""

from __future__ import annotations

import warnings
from collections.abc import Mapping

import numpy as np

from ev_core.methods.offered import offered, offered_module
from ev_msgs_py.refusal import ParameterError, quoted
from ev_stack.measures import handling, laps, motion
from ev_stack.measures.metric import HIGHER, LOWER, Metric, NotMeasured, channel
from ev_stack.measures.named import DrivenRun, NamedMetric
from ev_stack.recording.recording import Recording

# of entry points: the name of a package, and its module with METRICS, a tuple
OFFERED = "ev_stack.metrics"
_TWIST, _ANGLE = "twist.", motion.ROAD_WHEEL_ANGLE
_ACCELERATION = ("imu.longitudinal_acceleration", motion.LATERAL_ACCELERATION)
_FORCES = ("tire_forces.longitudinal_force.", "tire_forces.lateral_force.")


def _largest(values: np.ndarray) -> float:
    return float(np.abs(values).max())


def _battery_energy(run: Recording) -> float:
    # The current counts into the battery, so the energy taken has the opposite sign.
    power = -channel(run, "battery.voltage") * channel(run, "battery.current")
    return float(np.trapezoid(power, run.time))


def _torque_activity(run: Recording) -> float:
    # Changes from sample to sample: a constant torque is no activity, however large.
    commands = handling.of_wheels(run, "torque_command.drive")
    if run.duration <= 0.0:
        raise NotMeasured("the run has no duration")
    return float(np.abs(np.diff(commands)).sum()) / run.duration


def _friction(run: Recording) -> tuple[np.ndarray, np.ndarray]:
    """Force of each tyre, and what friction gives it at most, (4, n) each [N]."""
    force, across, load, friction = (
        handling.of_wheels(run, f"tire_forces.{of}")
        for of in ("longitudinal_force", "lateral_force", "load", "friction_coefficient")
    )
    return np.hypot(force, across), load * friction


def _friction_use(run: Recording) -> float:
    force, available = _friction(run)
    # A wheel in the air has no load and no force: its use is 0, not 0/0.
    return float(np.divide(force, available, where=available > 0.0, out=0.0 * available).max())


def _friction_use_of_car(run: Recording) -> np.ndarray:
    moves = motion.moving(run)
    if not moves.any():
        raise NotMeasured("the car does not move")
    force, available = (each.sum(axis=0)[moves] for each in _friction(run))
    # 1 N stands for a car with all wheels in the air.
    return force / np.maximum(available, 1.0)


_SLIP_RATIO, _SLIP_ANGLE, _FRICTION = (
    f"tire_forces.{of}." for of in ("slip_ratio", "slip_angle", "friction_coefficient")
)

_OF_ANY_RUN = (
    NamedMetric(
        "final_speed",
        "m/s",
        "V in the end, negative backwards",
        lambda run: motion.path_speed(run.signals)[-1],
        (_TWIST,),
    ),
    NamedMetric(
        "maximum_speed", "m/s", "max V", lambda run: motion.speed(run.signals).max(), (_TWIST,)
    ),
    NamedMetric(
        "distance",
        "m",
        "length of the path of the centre of mass",
        lambda run: motion.distance_on_path(run.signals)[-1],
        ("pose.",),
    ),
    NamedMetric(
        "maximum_yaw_rate",
        "rad/s",
        "max |r|",
        lambda run: _largest(channel(run.signals, motion.YAW_RATE)),
        (motion.YAW_RATE,),
    ),
    NamedMetric(
        "maximum_lateral_acceleration",
        "m/s^2",
        "max |a_y cos(beta) - a_x sin(beta)|, across the path",
        lambda run: _largest(motion.lateral_acceleration_on_path(run.signals)),
        (_TWIST, *_ACCELERATION),
    ),
    NamedMetric(
        "maximum_roll_angle",
        "rad",
        "max |phi| of a body that rolls on its suspension",
        lambda run: _largest(motion.roll_angle(run.signals)),
        ("imu.roll.",),
        LOWER,
    ),
    NamedMetric(
        "maximum_road_wheel_angle",
        "rad",
        "max |delta|",
        lambda run: _largest(handling.front_wheel_angle(run.signals, run.vehicle)),
        (_ANGLE,),
    ),
    NamedMetric(
        "maximum_total_drive_torque",
        "N m",
        "max |sum of the drive torques at the wheels|",
        lambda run: _largest(motion.total_drive_torque(run.signals)),
        ("wheel_states.effort.",),
    ),
    NamedMetric(
        "peak_sideslip",
        "rad",
        "max |beta| while the car moves",
        lambda run: handling.peak_sideslip(run.signals),
        (_TWIST,),
        LOWER,
    ),
    NamedMetric(
        "yaw_rate_error",
        "rad/s",
        "rms(r - u delta/(L + K_us u |u|)) while the car moves, within +-mu g/u",
        lambda run: handling.yaw_rate_error(run.signals, run.vehicle),
        (_TWIST, _ANGLE, motion.YAW_RATE),
        LOWER,
    ),
    NamedMetric(
        "understeer_gradient",
        "rad s^2/m",
        "slope of delta - L a_y/V^2 over a_y from 0.5 to 4 m/s^2, into the bend positive, of a car"
        " that turns steadily",
        lambda run: handling.measured_understeer_gradient(run.signals, run.vehicle),
        (_TWIST, _ANGLE, motion.YAW_RATE, *_ACCELERATION),
    ),
    NamedMetric(
        "peak_slip",
        "1",
        "max |slip ratio| of any wheel while the car moves",
        lambda run: handling.peak_slip_ratio(run.signals),
        (_TWIST, _SLIP_RATIO),
        LOWER,
    ),
    NamedMetric(
        "time_over_limit",
        "s",
        "time in which a tyre of the moving car slips beyond the peak of its curve",
        lambda run: handling.time_over_limit(run.signals, run.vehicle, run.surfaces),
        (_TWIST, _SLIP_RATIO, _SLIP_ANGLE, _FRICTION),
        LOWER,
    ),
    NamedMetric(
        "friction_use",
        "1",
        "max hypot(F_x, F_y)/(mu F_z) of any wheel",
        lambda run: _friction_use(run.signals),
        (*_FORCES, "tire_forces.load.", _FRICTION),
        LOWER,
    ),
    NamedMetric(
        "mean_friction_use",
        "1",
        "mean of sum hypot(F_x, F_y)/sum mu F_z of all wheels while the car moves",
        lambda run: _friction_use_of_car(run.signals).mean(),
        (_TWIST, *_FORCES, "tire_forces.load.", _FRICTION),
        HIGHER,
    ),
    NamedMetric(
        "high_friction_use",
        "1",
        "95th percentile of sum hypot(F_x, F_y)/sum mu F_z while the car moves",
        lambda run: np.percentile(_friction_use_of_car(run.signals), 95.0),
        (_TWIST, *_FORCES, "tire_forces.load.", _FRICTION),
        HIGHER,
    ),
    NamedMetric(
        "lap_time",
        "s",
        "shortest time from crossing the line of a closed course to crossing it again, on the road",
        lambda run: laps.lap_times(run.signals, run.vehicle, run.course).min(),
        ("pose.",),
        LOWER,
    ),
    NamedMetric(
        "path_error",
        "m",
        "rms distance of the centre of mass from the racing line in all whole laps",
        lambda run: laps.path_error(run.signals, run.vehicle, run.course),
        ("pose.",),
        LOWER,
    ),
    NamedMetric(
        "peak_winding_temperature",
        "degC",
        "max of the windings of all motors",
        lambda run: handling.of_wheels(run.signals, "motor_temperatures.winding").max(),
        ("motor_temperatures.winding.",),
        LOWER,
    ),
    NamedMetric(
        "slip_energy",
        "J",
        "integral of tyre force times slip speed, along and across, all wheels",
        lambda run: handling.slip_energy(run.signals, run.vehicle),
        (_TWIST, _ANGLE, "wheel_states.velocity.", *_FORCES),
        LOWER,
    ),
    NamedMetric(
        "drive_energy",
        "J",
        "sum of drive torque times angle turned, all wheels",
        lambda run: handling.drive_work(run.signals)[-1],
        ("wheel_states.position.", "wheel_states.effort."),
        LOWER,
    ),
    NamedMetric(
        "battery_energy",
        "J",
        "integral of U I at the terminals, taken from the battery",
        lambda run: _battery_energy(run.signals),
        ("battery.voltage", "battery.current"),
        LOWER,
    ),
    NamedMetric(
        "torque_activity",
        "N m/s",
        "sum of |changes of the torque commands| of all wheels over the duration",
        lambda run: _torque_activity(run.signals),
        ("torque_command.drive.",),
        LOWER,
    ),
)


def _offered() -> dict[str, NamedMetric]:
    """Metrics of other packages; a warning for a package with metrics that cannot be taken."""
    taken = {each.name for each in _OF_ANY_RUN}
    found: dict[str, NamedMetric] = {}
    # Sorted: which of two packages with the same name is refused must not depend on the
    # installation.
    for package in sorted(offered(OFFERED)):
        try:
            own = {
                each.name: each for each in offered_module(OFFERED, "metrics of", package).METRICS
            }
            if twice := sorted(own.keys() & (taken | found.keys())):
                raise ParameterError(
                    f"metrics of {package}: {quoted(twice[0])} is taken, expected another name"
                )
        # A package with a mistake must not stop commands that do not need it.
        except (AttributeError, TypeError, ParameterError) as error:
            warnings.warn(f"not loaded: {error}", stacklevel=1)
        else:
            found |= own
    return found


# At import: texts of scenarios are read by the names in METRICS from then on.
_OF_OTHERS = _offered()
METRICS: Mapping[str, NamedMetric] = {each.name: each for each in _OF_ANY_RUN} | _OF_OTHERS


def metrics_of_others(run: DrivenRun) -> dict[str, Metric]:
    """Metrics of other packages for which a run has the channels, such as of a CAN bus."""
    return {
        name: each.measured(run)
        for name, each in _OF_OTHERS.items()
        if not each.lacking(run.signals.channels)
    }
