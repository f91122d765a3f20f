"""Inputs of a replay without the noise that a difference of samples makes a force of.

The plant pushes the car by the differences of the imposed speed: noise of 0.05 m/s at 100 Hz would
be 7 m/s^2. A Butterworth filter of second order is passed over the samples forth and back, so it
delays nothing. Its cut-off follows from the noise of the record, which third differences of the
samples show: what a car does is too slow for them. It is the highest that leaves no more than
`LEFT` of this noise in the derivative, 2.6 Hz for the speed above and 7 Hz for a quarter of its
noise. Samples with less noise than that stay as they are.
"""

from __future__ import annotations

import numpy as np
from scipy.signal import butter, sosfiltfilt

from ev_study.measured.records.record import LATERAL, LONGITUDINAL, YAW_RATE, MeasuredRecord

SMOOTHED = (LONGITUDINAL, LATERAL, YAW_RATE)  # the imposed speed, and what a window begins from
# Noise that may stay in the derivative, RMS [m/s^2, rad/s^2]: a hundredth of what cars do.
LEFT = {LONGITUDINAL: 0.1, LATERAL: 0.1, YAW_RATE: 0.05}
LOWEST = 2.0  # [Hz] of a cut-off by noise; a driver's pedal and a car on its tyres are slower
_HIGHEST = 0.8  # of a cut-off by noise, over the Nyquist frequency
# White noise of density S, differentiated and filtered forth and back, has the variance 4 pi^2 S
# f^3 times this: the integral of x^2/(1 + x^4)^2.
_SHARE = 0.2777


def noise_of(record: MeasuredRecord, channel: str) -> float:
    """Standard deviation of white noise with the third differences of a channel, between samples of its sensor.

    Between them a slow channel is interpolated, which hides noise, so the places of the samples are
    those with most.
    """
    step = _step(record, channel)
    return max(_noise(record[channel][n::step], record.valid[n::step]) for n in range(step))


def _noise(values: np.ndarray, valid: np.ndarray) -> float:
    """Standard deviation of white noise with the third differences of values where all four are valid."""
    # A third difference needs four samples in a row.
    believed = valid[3:] & valid[2:-1] & valid[1:-2] & valid[:-3]
    differences = np.diff(values, 3)[believed]
    # White noise of variance s^2 has third differences of variance (1 + 9 + 9 + 1) s^2.
    return float(np.sqrt(np.mean(differences**2) / 20.0)) if len(differences) else 0.0


def cut_off_of(record: MeasuredRecord, channel: str) -> float:
    """The cut-off by the noise of a channel [Hz]; 0 where it stays as it is."""
    noise, spacing, left = (
        noise_of(record, channel),
        _step(record, channel) * record.period,
        LEFT[channel],
    )
    # The difference of two samples has the root of two of their noise.
    if np.sqrt(2.0) * noise / spacing <= left:
        return 0.0
    # One-sided: all of s^2 lies between 0 and the Nyquist frequency 1/(2 spacing).
    density = 2.0 * spacing * noise**2
    # The variance above solved for f.
    cut_off = float(np.cbrt(left**2 / (4.0 * np.pi**2 * _SHARE * density)))
    # The Nyquist frequency is that of the record, not of the sensor: the filter runs over instants.
    return min(max(cut_off, LOWEST), _HIGHEST * 0.5 / record.period)


def smoothed(record: MeasuredRecord, channel: str, cut_off: float | None = None) -> np.ndarray:
    """A channel without what is faster than `cut_off` [Hz], by its own noise for None, (n,)."""
    if cut_off is None:
        cut_off = cut_off_of(record, channel)
    return smoothed_values(record, record[channel], cut_off)


def smoothed_values(record: MeasuredRecord, values: np.ndarray, cut_off: float) -> np.ndarray:
    """A series of a record likewise, (n,).

    As it is for 0, or if the samples are too far apart or too few.

    Each stretch is smoothed by itself: where another drive begins behind a mask, its speed would be
    mixed with that of the one before, and the car be braked by the difference.
    """
    nyquist = 0.5 / record.period
    # Nothing in the samples is faster than the cut-off.
    if cut_off == 0.0 or nyquist <= cut_off:
        return values
    # One period of the cut-off on both sides keeps the ends from swinging.
    padded = round(1.0 / cut_off / record.period)
    long = [each for each in record.stretches if each.stop - each.start > padded]
    if not long:
        return values
    by_filter = butter(2, cut_off / nyquist, output="sos")
    found = values.copy()
    for stretch in long:
        found[stretch] = sosfiltfilt(by_filter, values[stretch], padlen=padded)
    return found


def rate_of(record: MeasuredRecord, values: np.ndarray) -> np.ndarray:
    """Rate of a series of a record, (n,).

    Not across a mask, behind which another drive may begin.
    """
    found = np.zeros(len(values))
    for stretch in record.stretches:
        # A single instant has no rate; it stays zero.
        if stretch.stop - stretch.start > 1:
            found[stretch] = np.gradient(values[stretch], record.period)
    return found


def with_acceleration(record: MeasuredRecord, speed: np.ndarray, cut_off: float | None) -> str:
    """The line on what the imposed speed asks for: the RMS of its differences, raw and smoothed."""
    raw, smooth = (_rms_of_rate(record, each) for each in (record[LONGITUDINAL], speed))
    if speed is record[LONGITUDINAL]:
        return (
            f"the imposed speed is not smoothed: its acceleration is {raw:.2g} m/s2 RMS, noise"
            " included"
        )
    by_noise = cut_off_of(record, LONGITUDINAL) if cut_off is None else cut_off
    why = f"{noise_of(record, LONGITUDINAL):.2g} m/s of noise, " if cut_off is None else ""
    return (
        f"the imposed speed is smoothed ({why}Butterworth, {by_noise:.2g} Hz, forth and back): its"
        f" acceleration is {smooth:.2g} m/s2 RMS, that of the raw samples {raw:.2g}"
    )


def _rms_of_rate(record: MeasuredRecord, values: np.ndarray) -> float:
    believed = record.valid[1:] & record.valid[:-1]
    return float(np.sqrt(np.mean((np.diff(values)[believed] / record.period) ** 2)))


def _step(record: MeasuredRecord, channel: str) -> int:
    """Instants between two samples of the sensor of a channel: between them it is interpolated."""
    return max(1, round(record.spacing.get(channel, record.period) / record.period))
