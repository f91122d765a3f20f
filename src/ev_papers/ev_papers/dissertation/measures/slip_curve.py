"""The slip curve of a wheel that passes its peak, fitted by least squares to recorded signals (dissertation, eq 2.36).

The same curve that traction control fits as it drives, here from the signals alone and with no noise to guard against.
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
LEAST_SPREAD = (
    0.01  # [1], standard deviation of the slip in a window that shows a curve and not a point
)
HITS = 5  # windows in a row whose curve falls in the end
LARGEST_ERROR = 1e-3  # [1], sum of the squared errors of a fit that counts; printed below eq 2.36
SLOWEST = 3.0  # [rad/s], of the free wheel; at rest slip has no meaning


@dataclass(frozen=True, slots=True, eq=False)
class SlipCurve:
    """y = A x + B sqrt(x) through the samples of a window: slips x [1] and road torques y over the nominal torque [1].

    `window` are the indices of its samples in the recording; the last one is where the peak counts as passed.
    """

    window: slice
    a: float
    b: float

    @property
    def peak(self) -> float:
        """Slip from which on the curve falls, (B/(2 A))^2 [1]."""
        return (self.b / (2 * self.a)) ** 2

    def at(self, slip: np.ndarray) -> np.ndarray:
        """The curve [1] at slips [1]."""
        return self.a * slip + self.b * np.sqrt(slip)


def slip_and_road_torque(
    run: Recording, vehicle: Vehicle, wheel: str
) -> tuple[np.ndarray, np.ndarray]:
    """X = 1 - w_free/w and y = (M - J w')/M_nom of a driven wheel over the period before each sample, (n,) [1].

    M_nom is that of the motor at the wheel. NotMeasured if there is no free wheel beside it.
    """
    speed = channel(run, f"wheel_states.velocity.{wheel}")
    free = channel(run, f"wheel_states.velocity.{free_wheel_beside(wheel, vehicle)}")
    slip = 1 - free / np.maximum(speed, SLOWEST)
    inertia = wheel_inertia(vehicle, wheel)
    road = channel(run, f"wheel_states.effort.{wheel}").copy()
    road[1:] -= inertia * np.diff(speed) / np.diff(run.time)
    # The road torque is a mean over the period, so it goes with the mean slip of the period.
    return (
        np.concatenate((slip[:1], (slip[1:] + slip[:-1]) / 2)),
        road / (vehicle.motor.nominal_torque * vehicle.gear_ratio),
    )


def first_passed_peak(run: Recording, vehicle: Vehicle, wheel: str) -> SlipCurve:
    """The fit where the wheel first passes its peak while it is driven on one surface and its slip only rises.

    NotMeasured if that never happens.
    """
    x, y = slip_and_road_torque(run, vehicle, wheel)
    period = float(run.time[1] - run.time[0]) if len(run.time) > 1 else WINDOW
    size = max(round(WINDOW / period), 2)
    if len(x) < size:
        raise NotMeasured(f"the run is shorter than {WINDOW:g} s")
    falling = 0
    for start in np.flatnonzero(_tells_a_peak(run, vehicle, wheel, x, size)):
        fit = _fitted(x, y, slice(int(start), int(start) + size))
        falls = fit is not None and fit.peak < x[fit.window][-1]
        falling = falling + 1 if falls else 0
        if falling == HITS:
            return fit
    raise NotMeasured(f"{wheel.replace('_', ' ')} never passes the peak of its slip curve")


def _tells_a_peak(
    run: Recording, vehicle: Vehicle, wheel: str, x: np.ndarray, size: int
) -> np.ndarray:
    """Whether the window that begins at a sample may be fitted, (n - size + 1,) bool."""

    def windows(values: np.ndarray) -> np.ndarray:
        return sliding_window_view(values, size)

    slips = windows(x)
    free = channel(run, f"wheel_states.velocity.{free_wheel_beside(wheel, vehicle)}")
    friction = windows(channel(run, f"tire_forces.friction_coefficient.{wheel}"))
    driven = windows(channel(run, f"wheel_states.effort.{wheel}")).min(axis=1) > 0.0
    rising = (np.diff(slips, axis=1) > 0.0).all(axis=1) & (slips[:, 0] > 0.0)
    enough = (slips[:, -1] > LEAST_SLIP) & (slips.std(axis=1) > LEAST_SPREAD)
    return (
        driven
        & rising
        & enough
        & (np.ptp(friction, axis=1) == 0.0)
        & (windows(free).min(axis=1) > SLOWEST)
    )


def _fitted(x: np.ndarray, y: np.ndarray, window: slice) -> SlipCurve | None:
    """The curve of least squared error F, None if it has no peak or F is too large."""
    (a, b), error, *_ = np.linalg.lstsq(np.column_stack((x[window], np.sqrt(x[window]))), y[window])
    good = a < 0.0 < b and error.sum() <= LARGEST_ERROR
    return SlipCurve(window, float(a), float(b)) if good else None
