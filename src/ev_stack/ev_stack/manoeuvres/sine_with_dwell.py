"""Report on the sine with dwell, by the measures of UN R140 and FMVSS 126.

Run `slowly_increasing_steer` gives the steering-wheel angle A at 0.3 g; the others are sines with
dwell, to the left or to the right first, for the regulation asks for both. A sine is what was
driven, whatever the run is called. The beginning of steer is where the angle passes 5 deg, as the
regulation has it, its completion the first instant at zero after the sine. From the last instant at
zero before the sine the displacement is less: that reading is reported as well.
"""

from __future__ import annotations

import re

import numpy as np

from ev_core.vehicle.car import GRAVITY
from ev_stack.figures.panels import Curve, motion_panels, over_time, panel, readable
from ev_stack.figures.sheets import Sheet
from ev_stack.measures import motion
from ev_stack.measures.handling import peak_sideslip
from ev_stack.measures.metric import (
    HIGHER,
    LOWER,
    Metric,
    NotJudged,
    NotMeasured,
    Runs,
    channel,
    metric,
    run_named,
)
from ev_stack.recording.recording import Recording
from ev_stack.running.steering_angles import angle_at

SLOW_RUN = "slowly_increasing_steer"
SHOWN_SIDESLIP = 30.0  # [deg], beyond which a car has spun and would flatten the others' curves
REFERENCE_ACCELERATION = 0.3 * GRAVITY  # [m/s^2]
# of the steering wheel, the beginning of steer (FMVSS 126, S7.11)
BEGINNING_OF_STEER = np.radians(5.0)
DISPLACEMENT_TIME = 1.07  # [s] after the beginning of steer
DISPLACEMENT = 1.83  # [m], at least, for cars up to 3500 kg and amplitudes of 5 A and more
FULL = 5.0  # [A]
ROUNDING = 0.01  # of an amplitude: A counts to a tenth of a degree
# [s] after the completion of steer, [%] of the peak yaw rate at most
YAW_LIMITS = ((1.0, 35.0), (1.75, 20.0))


def metrics(runs: Runs) -> dict[str, Metric]:
    """Metrics of the angle A and of each sine: amplitude, yaw rate ratios, displacement, verdict."""
    result = {
        "steering_wheel_angle_at_0_3_g": metric(
            lambda: _reference_angle(runs),
            "rad",
            "A: angle at 0.3 g on a slow ramp (FMVSS 126, S7.6)",
        )
    }
    for name, run in _sines(runs).items():
        result[f"{name}_amplitude"] = metric(
            lambda run=run: np.abs(channel(run, motion.STEERING_WHEEL_ANGLE)).max(),
            "rad",
            "max |steering-wheel angle|",
        )
        result[f"{name}_amplitude_over_a"] = metric(
            lambda run=run: _multiple(run, runs), "1", "the same over A"
        )
        for delay, _ in YAW_LIMITS:
            key = f"{delay:.2f}".replace(".", "_")
            result[f"{name}_yaw_rate_ratio_{key}_s"] = metric(
                lambda run=run, delay=delay: _yaw_rate_ratio(run, delay),
                "%",
                f"r {delay:g} s after the completion of steer over its second peak",
                LOWER,
            )
        result[f"{name}_lateral_displacement"] = metric(
            lambda run=run: _displacement(run, _beginning(run)),
            "m",
            "way aside 1.07 s after 5 deg",
            HIGHER,
        )
        result[f"{name}_lateral_displacement_from_zero"] = metric(
            lambda run=run: _displacement(run, float(run.time[_steering(run)[0]])),
            "m",
            "way aside 1.07 s after the last instant at 0 deg",
            HIGHER,
        )
        result[f"{name}_peak_sideslip_angle"] = metric(
            lambda run=run: peak_sideslip(run), "rad", "max |beta| while the car moves", LOWER
        )
        result[f"{name}_passed"] = metric(
            lambda name=name: _passes(name, runs),
            "1",
            "1: within the limits of FMVSS 126; else 0",
            HIGHER,
        )
    return result


def figures(runs: Runs) -> dict[str, Sheet]:
    """Steering-wheel angle, yaw rate, sideslip angle and lateral displacement of all sines."""
    sines = {_label(name, runs): run for name, run in _sines(runs).items()}

    panels = [
        *motion_panels(sines, "steering_wheel_angle", "yaw_rate"),
        over_time(
            sines,
            "Sideslip angle; a car that spins leaves the panel",
            "angle [deg]",
            lambda run: np.degrees(motion.sideslip_in_motion(run, continuous=True)),
            within=(-SHOWN_SIDESLIP, SHOWN_SIDESLIP),
        ),
        over_time(sines, "Lateral displacement", "y [m]", lambda run: channel(run, "pose.y")),
    ]

    def slow() -> list[Curve]:
        run = run_named(runs, SLOW_RUN)
        angle = np.degrees(channel(run, motion.STEERING_WHEEL_ANGLE))
        # Not the way back, on which the curve would be drawn a second time.
        rising = slice(0, int(np.abs(angle).argmax()) + 1)
        return [Curve(angle[rising], motion.lateral_acceleration_on_path(run)[rising])]

    line = panel("Slowly increasing steer", "lateral acceleration [m/s²]", slow)
    return {
        "sine_with_dwell": Sheet(panels),
        SLOW_RUN: Sheet([line], "steering-wheel angle [deg]"),
    }


def _label(name: str, runs: Runs) -> str:
    """The multiple of A that was driven, or the name of the run where A is not known."""
    try:
        return f"{_multiple(runs[name], runs):.1f} A"
    except NotMeasured:
        return readable(name)


def _sines(runs: Runs) -> dict[str, Recording]:
    return {name: run for name, run in runs.items() if name != SLOW_RUN}


def _reference_angle(runs: Runs) -> float:
    """Steering-wheel angle A at 0.3 g, of either side [rad]."""
    return angle_at(run_named(runs, SLOW_RUN), REFERENCE_ACCELERATION)


def _multiple(run: Recording, runs: Runs) -> float:
    amplitude = np.abs(channel(run, motion.STEERING_WHEEL_ANGLE)).max()
    return float(amplitude / _reference_angle(runs))


def _steering(run: Recording) -> tuple[int, int]:
    """Indices of the beginning and of the completion of steer."""
    turned = np.flatnonzero(channel(run, motion.STEERING_WHEEL_ANGLE))
    # Without an instant at zero on both sides neither beginning nor completion of steer is known.
    if not len(turned) or turned[0] == 0 or turned[-1] == len(run.time) - 1:
        raise NotMeasured("there is no complete sine")
    return int(turned[0]) - 1, int(turned[-1]) + 1


def _peak_yaw_rate(run: Recording) -> float:
    """First local peak of the yaw rate after the steering-wheel angle has changed sign [rad/s]."""
    begin, end = _steering(run)
    angle, yaw_rate = channel(run, motion.STEERING_WHEEL_ANGLE), channel(run, motion.YAW_RATE)
    reversal = (
        begin
        + 1
        + motion.first(
            angle[begin + 1 : end] * angle[begin + 1] < 0.0, "the second half of the sine"
        )
    )
    # Towards the second steering: a sine to the left and one to the right have the same peak.
    towards = np.sign(angle[reversal]) * yaw_rate[reversal:]
    # Strict on one side only: of a flat top exactly the last sample counts.
    falling = (
        (towards[1:-1] > 0.0) & (towards[1:-1] >= towards[:-2]) & (towards[1:-1] > towards[2:])
    )
    return float(yaw_rate[reversal + 1 + motion.first(falling, "the second peak of the yaw rate")])


def _yaw_rate_ratio(run: Recording, delay: float) -> float:
    _, end = _steering(run)
    now = motion.value_at(run, channel(run, motion.YAW_RATE), float(run.time[end]) + delay)
    return 100 * now / _peak_yaw_rate(run)


def _beginning(run: Recording) -> float:
    """When the steering wheel has turned by 5 deg [s]."""
    angle = np.abs(channel(run, motion.STEERING_WHEEL_ANGLE))
    return motion.crossing_time(run.time, angle, BEGINNING_OF_STEER, "5 deg of the steering wheel")


def _displacement(run: Recording, beginning: float) -> float:
    """Displacement of the centre of mass across its former straight path [m].

    Positive in the direction of the first steering.
    """
    begin, _ = _steering(run)
    # The first sample with an angle, since the one at `begin` is still zero.
    side = np.sign(channel(run, motion.STEERING_WHEEL_ANGLE)[begin + 1])
    return side * motion.value_at(run, motion.way_aside(run, begin), beginning + DISPLACEMENT_TIME)


def _passes(name: str, runs: Runs) -> float:
    """1 if the yaw rate falls fast enough and, from 5 A on, the car answers far enough; else 0.

    NotJudged if the run is not the one of its name: a car that has passed with less has not passed.
    """
    run = run_named(runs, name)
    multiple, found = _multiple(run, runs), re.search(r"times_(\d+)_(\d+)", name)
    named = float(f"{found[1]}.{found[2]}") if found else 0.0  # 1.5 of times_1_5
    if named and abs(multiple / named - 1.0) > ROUNDING:
        raise NotJudged(f"{multiple:.2f} A was driven, the run is about {named:g} A")
    # The limits are upper ones: a yaw rate that has swung to the other side is within them.
    stable = all(_yaw_rate_ratio(run, delay) <= limit for delay, limit in YAW_LIMITS)
    responsive = (
        multiple < FULL * (1.0 - ROUNDING) or _displacement(run, _beginning(run)) >= DISPLACEMENT
    )
    return float(stable and responsive)
