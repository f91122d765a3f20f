"""Parameters of a car from a record: least squares over windows that are replayed open loop, many cars at once.

How it works: the parameters are divided by their scales, so that one step and one tolerance fit all
of them. For the derivatives a batch drives the car at a point and, for each parameter, a step
beside it. A first fit weighs the signals roughly; what it leaves gives the weights of the fits that
count, from one or several starts. A prior about the start is added as further rows of the least
squares.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import OptimizeResult, least_squares

from ev_study.measured.free_parameters import FreeParameter, changes
from ev_study.measured.records.record import LONGITUDINAL, SIDESLIP, YAW_RATE
from ev_study.measured.replays.open_loop import OpenLoop
from ev_study.studies.result_store import Answers

# of a scale, for forward differences: far above rounding, far below any curvature of the errors
STEP = 1e-3
# Finite, so that the sum of squares stays one; large errors of other windows are cut at it too, so
# that a car with numbers is never judged worse than one without.
WORST = 50.0  # weighted error of a window in which the car has no finite numbers
# Least weights where a mapping declares no noise: what good sensors of cars are off by, 0.2 deg/s
# and 0.1 deg.
FLOORS = {YAW_RATE: 0.0035, SIDESLIP: 0.0017}
FLOOR = 0.01  # of other signals, in shares of their standard deviation


@dataclass(frozen=True)
class Fitted:
    """Parameters (n,), errors over their weights (windows, m), their derivatives by scaled parameters, and how it went.

    `weights` are the RMS errors by signal that are left, in the unit of the signal, and at least
    its noise; `costs` those of all starts. `converged`: the best search came to its end before its
    steps did.
    """

    values: np.ndarray
    residuals: np.ndarray
    derivatives: np.ndarray
    weights: Mapping[str, float]
    costs: tuple[float, ...]
    evaluations: int
    converged: bool


class Residuals:
    """Weighted errors of a replay at points in scaled parameters, and their derivatives by these."""

    def __init__(
        self,
        replay: OpenLoop,
        free: Sequence[FreeParameter],
        weights: Mapping[str, float],
        every: int,
        width: float,
        answers: Answers | None = None,
    ) -> None:
        """Take each `every`-th sample; the prior about the start is `width` scales wide."""
        self._replay, self._free, self.weights, self._every = replay, free, weights, every
        self._answers = answers
        self.scale = np.array([each.scale for each in free])
        # From here on all points are in scales; only `changes` gets numbers with units.
        self.begin = np.array([each.start for each in free]) / self.scale
        self.ends = np.array([[each.low, each.high] for each in free]).T / self.scale
        self._measured = {name: replay.measured(name)[:, ::every] for name in weights}
        self._width = width

    def at(self, points: np.ndarray) -> np.ndarray:
        """(points, windows, signals times samples)."""
        if self._answers is None:
            return self._computed(points)
        return self._answers.answer(self.weights, points, self._computed)

    def _computed(self, points: np.ndarray) -> np.ndarray:
        cars = changes(
            self._free, np.clip(points, *self.ends) * self.scale, self._replay.configurations
        )
        found = self._replay.simulate(cars)
        errors = [
            (found[n][:, :, :: self._every] - self._measured[n]) / w
            for n, w in self.weights.items()
        ]
        for each, measured in zip(errors, self._measured.values(), strict=True):
            # Before NaN is replaced below: what is NaN there is the simulated car, here it is the
            # record.
            each[:, ~np.isfinite(measured)] = 0.0  # not measured there
        return np.clip(np.nan_to_num(np.concatenate(errors, axis=2), nan=WORST), -WORST, WORST)

    def derivatives(self, point: np.ndarray) -> np.ndarray:
        """Forward differences, away from an end that is near.

        The result is (windows, signals times samples, parameters).
        """
        # The batch that drives the point drives all its neighbours, too: one start of the compiled
        # run.
        steps = np.where(point + STEP > self.ends[1], -STEP, STEP)
        found = self.at(np.vstack([point, point + np.diag(steps)]))
        return np.moveaxis((found[1:] - found[0]) / steps[:, None, None], 0, 2)

    def left(self, point: np.ndarray, floors: Mapping[str, float]) -> dict[str, float]:
        """The RMS error of each signal in the median window, in its unit, and at least its floor.

        Of what was measured: a sideslip angle is not where the car hardly moves.
        """
        found = {}
        for name, errors in zip(
            self.weights, np.split(self.at(point[None])[0], len(self.weights), axis=1), strict=True
        ):
            # Errors are zero where nothing was measured, so their sum is right and only the count
            # has to know.
            count = np.isfinite(self._measured[name]).sum(axis=1)
            squares = (errors**2).sum(axis=1)[count > 0] / count[count > 0]
            found[name] = max(float(np.median(np.sqrt(squares))) * self.weights[name], floors[name])
        return found

    def fit(self, begin: np.ndarray, most: int) -> OptimizeResult:
        """Least squares from a point on, with the loss soft_l1 beyond three weights, in at most so many steps."""
        low, high = self.ends
        # A start that was drawn may lie beyond an end, which least_squares refuses.
        inside = np.clip(begin, low + 1e-6 * (high - low), high - 1e-6 * (high - low))
        # The prior's rows pass through soft_l1 as the others do: three widths away it pulls
        # linearly.
        prior = np.eye(len(begin)) / self._width
        return least_squares(
            lambda point: np.append(self.at(point[None])[0].ravel(), (point - self.begin) / self._width),
            inside,
            lambda point: np.vstack([self.derivatives(point).reshape(-1, len(point)), prior]),
            (low, high), loss="soft_l1", f_scale=3.0, max_nfev=most, xtol=1e-4, ftol=1e-4,
        )  # fmt: skip


def floors_of(replay: OpenLoop, signals: Sequence[str]) -> dict[str, float]:
    """Noise of each signal, as declared of its sensor or that of a good one."""
    deviations = {name: float(np.nanstd(replay.measured(name))) for name in signals}
    return {
        n: replay.record.noise.get(n) or FLOORS.get(n, FLOOR * of) for n, of in deviations.items()
    }


def moved_by_scales(
    replay: OpenLoop, free: Sequence[FreeParameter], fitted: Fitted, every: int, width: float
) -> dict[str, np.ndarray]:
    """Moves of each parameter, in its unit, by a per cent too much of a measured input, (n,).

    One step of Gauss and Newton from the optimum, by input. A fit cannot see such an error: other
    parameters reproduce it.
    """
    scale, found = np.array([each.scale for each in free]), {}
    by_parameters = fitted.derivatives.reshape(-1, len(free))
    # Minus from Gauss and Newton: the fit moves so that the change of the errors is undone.
    whole = by_parameters.T @ by_parameters + np.eye(len(free)) / width**2
    for channel in (LONGITUDINAL, replay.steering_channel):
        more = Residuals(replay.scaled(channel, 1.01), free, fitted.weights, every, width)
        change = (more.at((fitted.values / scale)[None])[0] - fitted.residuals).ravel()
        found[channel] = -np.linalg.solve(whole, by_parameters.T @ change) * scale
    return found


def identify(
    replay: OpenLoop,
    free: Sequence[FreeParameter],
    signals: Sequence[str],
    *,
    every: int,
    width: float,
    starts: int,
    seed: int,
    most: int,
    progress: Callable[[str], None] = lambda line: None,
    answers: Answers | None = None,
) -> Fitted:
    """Fit from several starts and keep the best: that of the file, and others drawn by the seed.

    These lie up to 20 % of a scale beside it. Errors are weighed by what is left of them in the
    median window, the likeliest weights under an unknown noise: a first fit weighs each signal by a
    tenth of its standard deviation, the second by what the first has left. No weight is below the
    noise that is declared of its sensor, or below `FLOORS`: a signal that happens to fit well would
    else buy its last hundredth with much of another one.
    """
    # Phase 1: rough weights, which let each signal have a say whatever its unit.
    floors = floors_of(replay, signals)
    weights = {
        name: max(0.1 * float(np.nanstd(replay.measured(name))), floors[name]) for name in signals
    }
    of = Residuals(replay, free, weights, every, width, answers)
    first = of.fit(of.begin, most)
    progress(f"start 1: cost {first.cost:.6g} in {first.nfev} steps, by a tenth of each signal")
    # Phase 2: all starts have the same weights from here on, else their costs could not be
    # compared.
    of = Residuals(replay, free, of.left(first.x, floors), every, width, answers)
    random = np.random.Generator(np.random.PCG64(seed))
    found = []
    for number in range(starts):
        # The first start goes on where the rough fit has ended; the others look for other minima.
        beside = of.begin + random.uniform(-0.2, 0.2, len(free)) if number else first.x
        found.append(of.fit(beside, most))
        progress(
            f"start {number + 1}: cost {found[-1].cost:.6g} in {found[-1].nfev} steps, by the"
            " errors left"
        )
    best = min(found, key=lambda each: float(each.cost))
    return Fitted(
        best.x * of.scale,
        of.at(best.x[None])[0],
        of.derivatives(best.x),
        of.weights,
        tuple(float(each.cost) for each in found),
        int(first.nfev) + sum(int(each.nfev) for each in found),
        # Of scipy: 0 is the end of the steps, above it one of the tolerances was met.
        int(best.status) > 0,
    )
