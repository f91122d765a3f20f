"""Inputs of a replay without the noise that a difference of samples makes a force of.

The plant pushes the car by the differences of the imposed speed: noise of 0.05 m/s at 100 Hz would be 7 m/s^2. A
Butterworth filter of second order is passed over the samples forth and back: it delays nothing, keeps what is slower
than a driver's pedal, and leaves 0.1 m/s^2 of that noise.
"""

from __future__ import annotations

import numpy as np
from scipy.signal import butter, sosfiltfilt

from ev_sim.measured.records.record import LATERAL, LONGITUDINAL, YAW_RATE, MeasuredRecord

SMOOTHED = (LONGITUDINAL, LATERAL, YAW_RATE)  # the imposed speed, and what a window begins from
CUT_OFF = 3.0  # [Hz], where half is left; of the motion of a car on its tyres nearly all is below 2 Hz


def smoothed(record: MeasuredRecord, channel: str, cut_off: float = CUT_OFF) -> np.ndarray:
    """A channel without what is faster than `cut_off` [Hz], (n,)."""
    return smoothed_values(record[channel], record.period, cut_off)


def smoothed_values(values: np.ndarray, period: float, cut_off: float = CUT_OFF) -> np.ndarray:
    """A series likewise; as it is for 0, or if the samples are too far apart or too few."""
    if cut_off == 0.0:
        return values
    nyquist = 0.5 / period
    padded = round(1.0 / cut_off / period)
    if nyquist < 2.0 * cut_off or len(values) <= padded:
        return values
    found: np.ndarray = sosfiltfilt(butter(2, cut_off / nyquist, output="sos"), values, padlen=padded)
    return found


def with_acceleration(record: MeasuredRecord, speed: np.ndarray, cut_off: float) -> str:
    """The line on what the imposed speed asks for: the RMS of its differences, raw and smoothed."""
    raw, smooth = (
        float(np.sqrt(np.mean((np.diff(each) / record.period)[record.valid[1:]] ** 2)))
        for each in (record[LONGITUDINAL], speed)
    )
    if cut_off == 0.0:
        return f"the imposed speed is not smoothed: its acceleration is {raw:.2g} m/s2 RMS, noise included"
    return (
        f"the imposed speed is smoothed (Butterworth, {cut_off:g} Hz, forth and back): its acceleration is "
        f"{smooth:.2g} m/s2 RMS, that of the raw samples {raw:.2g}"
    )
