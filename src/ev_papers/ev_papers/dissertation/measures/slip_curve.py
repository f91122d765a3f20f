"""Slip curve of a wheel that passes its peak, by least squares; dissertation, eq. 2.36.

The same curve that traction control fits as it drives, here from the signals alone and with no
noise to guard against.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.lib.stride_tricks import sliding_window_view

from ev_core.vehicle.description import Vehicle
from ev_core.vehicle.driveline import wheel_inertia
from ev_papers.dissertation.measures.circuits import free_wheel_beside
from ev_stack.measures.metric import NotMeasured, channel
from ev_stack.recording.recording import Recording

WINDOW = 0.125  # [s]; the source gives no length
LEAST_SLIP = 0.03  # [1], below it no wheel has passed its peak
# Standard deviation of the slip in a window that shows a curve and not a point [1].
LEAST_SPREAD = 0.01
HITS = 5  # windows in a row with a curve that falls in the end
LARGEST_ERROR = 1e-3  # [1], sum of the squared errors of a fit that counts; printed below eq 2.36
# Slips between which a wheel neither grips nor spins [1]; eq 1.5 ends a control at 0.15.
LITTLE_SLIP, MUCH_SLIP = 0.05, 0.15
SLOWEST = 3.0  # [rad/s], of the free wheel; at rest slip has no meaning


@dataclass(frozen=True, slots=True, eq=False)
class SlipCurve:
    """Curve y = A x + B sqrt(x) through the samples of a window.

    x are slips [1], y road torques over the nominal torque [1]. `window` are the indices of its
    samples in the recording; the last one is where the peak counts as passed.
    """

    window: slice
    a: float
    b: float

    @property
    def peak(self) -> float:
        """Slip from which on the curve falls, (B/(2 A))^2 [1]."""
        return (self.b / (2 * self.a)) ** 2

    def at(self, slip: np.ndarray) -> np.ndarray:
        """Road torque of the curve at slips [1]."""
        return self.a * slip + self.b * np.sqrt(slip)


def slip_and_road_torque(
    run: Recording, vehicle: Vehicle, wheel: str
) -> tuple[np.ndarray, np.ndarray]:
    """Slip x = 1 - w_free/w and road torque y = (M - J w')/M_nom of a driven wheel, (n,) [1].

    Both are those of the period before each sample. M_nom is that of the motor at the wheel.
    NotMeasured if there is no free wheel beside it.
    """
    speed = channel(run, f"wheel_states.velocity.{wheel}")
    free = channel(run, f"wheel_states.velocity.{free_wheel_beside(wheel, vehicle)}")
    slip = 1 - free / np.maximum(speed, SLOWEST)
    inertia = wheel_inertia(vehicle, wheel)
    road = channel(run, f"wheel_states.effort.{wheel}").copy()
    road[1:] -= inertia * np.diff(speed) / np.diff(run.time)
    # The road torque is a mean over the period, so it goes with the mean slip of the period.
    mean_slip = np.concatenate((slip[:1], (slip[1:] + slip[:-1]) / 2))
    return mean_slip, road / (vehicle.motor.nominal_torque * vehicle.gear_ratio)


def first_passed_peak(run: Recording, vehicle: Vehicle, wheel: str) -> SlipCurve:
    """Fit where a driven wheel first passes its peak on one surface while its slip only rises.

    Window after window is fitted; a few in a row with curves that fall in the end are no noise.
    NotMeasured if that never happens.
    """
    x, y = slip_and_road_torque(run, vehicle, wheel)
    period = float(run.time[1] - run.time[0]) if len(run.time) > 1 else WINDOW
    size = max(round(WINDOW / period), 2)
    if len(x) < size:
        raise NotMeasured(f"the run is shorter than {WINDOW:g} s")
    falling = 0
    for start in np.flatnonzero(_may_be_fitted(run, vehicle, wheel, x, size)):
        fit = _fitted(x, y, slice(int(start), int(start) + size))
        falls = fit is not None and fit.peak < x[fit.window][-1]
        falling = falling + 1 if falls else 0
        if falling == HITS:
            return fit
    raise NotMeasured(f"{wheel.replace('_', ' ')} never passes the peak of its slip curve")


def _may_be_fitted(
    run: Recording, vehicle: Vehicle, wheel: str, x: np.ndarray, size: int
) -> np.ndarray:
    """True where the window that begins at a sample may be fitted, (n - size + 1,) bool."""

    def windows(values: np.ndarray) -> np.ndarray:
        return sliding_window_view(values, size)

    slips = windows(x)
    free = windows(channel(run, f"wheel_states.velocity.{free_wheel_beside(wheel, vehicle)}"))
    friction = windows(channel(run, f"tire_forces.friction_coefficient.{wheel}"))
    torque = windows(channel(run, f"wheel_states.effort.{wheel}"))
    is_driven = torque.min(axis=1) > 0.0
    is_rising = (np.diff(slips, axis=1) > 0.0).all(axis=1) & (slips[:, 0] > 0.0)
    is_wide = (slips[:, -1] > LEAST_SLIP) & (slips.std(axis=1) > LEAST_SPREAD)
    on_one_surface = np.ptp(friction, axis=1) == 0.0
    is_rolling = free.min(axis=1) > SLOWEST
    return is_driven & is_rising & is_wide & on_one_surface & is_rolling


def _fitted(x: np.ndarray, y: np.ndarray, window: slice) -> SlipCurve | None:
    """Curve of least squared error F; None if it has no peak or F is too large."""
    template = np.column_stack((x[window], np.sqrt(x[window])))
    (a, b), error, *_ = np.linalg.lstsq(template, y[window])
    has_peak = a < 0.0 < b
    if not has_peak or error.sum() > LARGEST_ERROR:
        return None
    return SlipCurve(window, float(a), float(b))
