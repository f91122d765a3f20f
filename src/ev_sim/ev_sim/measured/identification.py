"""Parameters of a car from a record: least squares over windows that are replayed open loop, all cars of a step at once."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import OptimizeResult, least_squares

from ev_sim.measured.free_parameters import FreeParameter, changes
from ev_sim.measured.open_loop import OpenLoop

STEP = 1e-3  # of a scale, for forward differences: far above rounding, far below any curvature of the errors
WORST = 50.0  # weighted error of a window whose car has left all numbers behind


@dataclass(frozen=True)
class Fitted:
    """The parameters (n,), errors over their weights (windows, m) and their derivatives by scaled parameters."""

    values: np.ndarray
    residuals: np.ndarray
    derivatives: np.ndarray
    cost: float
    costs: tuple[float, ...]
    evaluations: int


class Errors:
    """Weighted errors of a replay at points in scaled parameters, and their derivatives; the last point is kept."""

    def __init__(self, replay: OpenLoop, free: Sequence[FreeParameter], weights: Mapping[str, float], every: int) -> None:
        self._replay, self._free, self._weights, self._every = replay, free, weights, every
        self._scale = np.array([each.scale for each in free])
        self._measured = {name: replay.measured(name)[:, ::every] for name in weights}
        self.ends = np.array([[each.low, each.high] for each in free]).T / self._scale

    def at(self, points: np.ndarray) -> np.ndarray:
        """(points, windows, signals times samples), each over the root of the number of samples of all windows."""
        cars = changes(self._free, np.clip(points, *self.ends) * self._scale, self._replay.configurations)
        found = self._replay.simulate(cars)
        errors = [(found[n][:, :, :: self._every] - self._measured[n]) / w for n, w in self._weights.items()]
        return np.clip(np.nan_to_num(np.concatenate(errors, axis=2), nan=WORST), -WORST, WORST)

    def residuals(self, point: np.ndarray) -> np.ndarray:
        """Of one point, flat."""
        return self.at(point[None])[0].ravel()

    def derivatives(self, point: np.ndarray) -> np.ndarray:
        """By forward differences, away from an end that is near; (numbers, parameters)."""
        steps = np.where(point + STEP > self.ends[1], -STEP, STEP)
        found = self.at(np.vstack([point, point + np.diag(steps)])).reshape(len(point) + 1, -1)
        return ((found[1:] - found[0]) / steps[:, None]).T


def identify(
    errors: Errors,
    free: Sequence[FreeParameter],
    starts: int,
    seed: int,
    most: int,
    progress: Callable[[int, float], None] = lambda number, cost: None,
) -> Fitted:
    """The best of several starts: that of the file, and others up to 20 % of a scale beside it, drawn by the seed.

    The loss is soft_l1 beyond three weights, so that windows that no car of this kind follows do not decide. Each start
    takes at most `most` steps.
    """
    random = np.random.Generator(np.random.PCG64(seed))
    begin = np.array([each.start / each.scale for each in free])
    found: list[OptimizeResult] = []
    for number in range(starts):
        beside = begin + (random.uniform(-0.2, 0.2, len(free)) if number else 0.0)
        low, high = errors.ends
        inside = np.clip(beside, low + 1e-6 * (high - low), high - 1e-6 * (high - low))
        found.append(
            least_squares(
                errors.residuals, inside, errors.derivatives, (low, high), loss="soft_l1", f_scale=3.0, max_nfev=most,
                xtol=1e-5, ftol=1e-5,
            )
        )  # fmt: skip
        progress(number, float(found[-1].cost))
    best = min(found, key=lambda each: float(each.cost))
    windows = len(errors.at(best.x[None])[0])
    scale = np.array([each.scale for each in free])
    return Fitted(
        best.x * scale,
        best.fun.reshape(windows, -1),
        errors.derivatives(best.x).reshape(windows, -1, len(free)),
        float(best.cost),
        tuple(float(each.cost) for each in found),
        sum(int(each.nfev) for each in found),
    )
