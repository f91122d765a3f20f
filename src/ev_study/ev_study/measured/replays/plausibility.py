"""Agreement of channels: r with u delta/L, lateral acceleration with u r, longitudinal with du/dt.

A car that understeers, slides or leans stays far inside these limits. Outside are sensors of
another sign or unit, velocities of another frame, and channels that nothing measures.

How it works: pairs of channels that physics ties to each other are compared in what a car can do,
below 3 Hz and above walking pace. Their correlation shows an opposite sign, the ratio of their
deviations a wrong unit. Where the car hardly turns or accelerates nothing is compared: only noise
would be.
"""

from __future__ import annotations

import numpy as np

from ev_study.measured.records.record import (
    LATERAL,
    LATERAL_ACCELERATION,
    LONGITUDINAL,
    LONGITUDINAL_ACCELERATION,
    ROAD_WHEEL_ANGLE,
    SIDESLIP,
    STEERING_WHEEL_ANGLE,
    YAW_RATE,
)
from ev_study.measured.replays.open_loop import OpenLoop
from ev_study.measured.replays.smoothing import rate_of, smoothed, smoothed_values

_SLOW = 3.0  # [Hz], up to which channels are compared: all that a car on its tyres does
_FAST = 3.0  # [m/s], from which on a car shows how it drives
_MOVES = 0.02  # [rad/s]; a yaw rate, measured or asked for, that deviates by less shows nothing
_ACCELERATES = 0.3  # [m/s^2], likewise
# correlation below which two channels have opposite signs; of driving it is above 0.5
_OPPOSED = -0.3
_FEWEST = 100  # instants
# A car turns as little of u delta/L as 1/(1 + (u/_LEAST)^2), with the lowest characteristic speed
# [m/s] of cars.
_LEAST = 10.0
_MOST_SIDESLIP = np.radians(30.0)  # of the median: no car drives so for half of its record


def contradictions(replay: OpenLoop) -> list[str]:
    """A line for each pair of channels that cannot both be right, and for each that does not change as it should."""
    record = replay.record
    moving = record.valid & (np.abs(record[LONGITUDINAL]) > _FAST)
    # A car that hardly moves shows nothing of its sensors.
    if moving.sum() < _FEWEST:
        return []
    speed, rate = smoothed(record, LONGITUDINAL, _SLOW), smoothed(record, YAW_RATE, _SLOW)
    wheelbase = replay.configurations["plant"].common.vehicle.wheelbase
    angle = smoothed_values(record, replay.road_wheel_angle, _SLOW)
    # The yaw rate of a car without slip angles.
    asked = (speed * angle / wheelbase)[moving]
    found = _constant(replay, moving, max(float(np.std(asked)), float(np.std(rate[moving]))))
    # A constant channel has no deviation and no correlation.
    if found:
        return found
    # Half of what understeer leaves of it at most.
    typical = float(np.sqrt(np.mean(speed[moving] ** 2)))
    least = 0.5 / (1.0 + (typical / _LEAST) ** 2)
    if max(float(np.std(asked)), float(np.std(rate[moving]))) > _MOVES:
        found += _compared(
            YAW_RATE, rate[moving], "speed times steering angle over wheelbase", asked, least, 5.0
        )
    channels = record.channels
    if LATERAL_ACCELERATION in channels:
        turning = speed * rate
        if LATERAL in channels:
            # a_y = u r + dv/dt; the second part is small but in fast changes.
            turning = turning + rate_of(record, smoothed(record, LATERAL, _SLOW))
        own = smoothed(record, LATERAL_ACCELERATION, _SLOW)[moving]
        if np.std(turning[moving]) > _ACCELERATES:
            found += _compared(
                LATERAL_ACCELERATION, own, "speed times yaw rate", turning[moving], 0.5, 2.0
            )
    if LONGITUDINAL_ACCELERATION in channels:
        # An accelerometer also shows the slope of the road, so these limits are wider.
        faster = rate_of(record, speed)[moving]
        own = smoothed(record, LONGITUDINAL_ACCELERATION, _SLOW)[moving]
        if np.std(faster) > _ACCELERATES:
            found += _compared(
                LONGITUDINAL_ACCELERATION, own, "the change of speed", faster, 0.3, 3.0
            )
    if SIDESLIP in channels:
        median = float(np.nanmedian(np.abs(channels[SIDESLIP][moving])))
        if median > _MOST_SIDESLIP:
            found.append(
                f"the median sideslip angle is {np.degrees(median):.0f} deg: velocities of another"
                " frame, such as east and north, expected are those along and across the car"
            )
    return found


def _constant(replay: OpenLoop, moving: np.ndarray, deviation: float) -> list[str]:
    """Channels that do not change though the car turns."""
    if deviation < _MOVES:
        return []
    angle = ROAD_WHEEL_ANGLE if ROAD_WHEEL_ANGLE in replay.record.channels else STEERING_WHEEL_ANGLE
    turning = (YAW_RATE, angle, LATERAL, LATERAL_ACCELERATION, SIDESLIP)
    return [
        f"{name} is {values[moving][0]:.4g} throughout though the car turns: not measured, leave it"
        " out of the mapping"
        for name, values in replay.record.channels.items()
        if name in turning and np.ptp(values[moving]) == 0.0
    ]


def _compared(
    name: str, values: np.ndarray, what: str, expected: np.ndarray, least: float, most: float
) -> list[str]:
    """A line if a channel has the opposite sign of what it is expected to be near to, or quite another size."""
    size, own = float(np.std(expected)), float(np.std(values))
    # corrcoef would be NaN.
    if min(size, own) == 0.0:
        return []
    correlation = float(np.corrcoef(values, expected)[0, 1])
    if correlation < _OPPOSED:
        return [
            f"{name} has the opposite sign of {what} (correlation {correlation:.2f}): sign or frame"
            " of one of them"
        ]
    if not least <= own / size <= most:
        ratio = f"{own / size:.3g} times as large as {what}, expected {least:.2g} to {most:.2g}"
        return [f"{name} is {ratio}: unit of one of them"]
    return []
