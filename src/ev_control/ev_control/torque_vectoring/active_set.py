"""Small dense quadratic program with bounds, by active sets (Nocedal & Wright 2006, 16.5)."""

from dataclasses import dataclass

from ev_core.law import compilable, series, sqrt

SIZE = 10  # unknowns
_ROUNDS = 6 * SIZE  # each frees or binds one unknown
_CLOSE = 1e-10  # of the largest gradient, below which a bound is not left


@dataclass(slots=True)
class Program:
    """Least of x'Hx/2 + c'x within low <= x <= high; of matrices the lower half, row by row."""

    hessian: list[float] = series(SIZE * SIZE, unit="its own")
    slope: list[float] = series(SIZE, unit="its own")
    low: list[float] = series(SIZE, unit="its own")
    high: list[float] = series(SIZE, unit="its own")
    x: list[float] = series(SIZE, unit="its own")
    bound: list[float] = series(SIZE, unit="1", about="1 for an unknown that is at a bound")
    factor: list[float] = series(
        SIZE * SIZE, unit="its own", about="of Cholesky, of the free unknowns"
    )
    step: list[float] = series(SIZE, unit="its own")


@compilable
def solve(w: Program) -> None:
    """Set x to the optimum, from the x that is there, cut to its bounds.

    Each round goes to the least of the free unknowns, or as far as the first bound on the way,
    which then holds. At the least the bound that costs most is left, until none costs anything.
    """
    for i in range(SIZE):
        w.x[i] = min(max(w.x[i], w.low[i]), w.high[i])
        w.bound[i] = 1.0 if w.x[i] == w.low[i] or w.x[i] == w.high[i] else 0.0
    for _ in range(_ROUNDS):
        towards_least(w)
        # The first bound on the way, and the part of the step up to it.
        share, hit = 1.0, -1
        for i in range(SIZE):
            if w.bound[i] == 0.0:
                end = w.high[i] if w.step[i] > 0.0 else w.low[i]
                if abs(w.step[i]) * share > abs(end - w.x[i]):
                    share, hit = (end - w.x[i]) / w.step[i], i
        for i in range(SIZE):
            if w.bound[i] == 0.0:
                w.x[i] += share * w.step[i]
        # Exactly onto the bound: rounding must not leave it just beside.
        if hit >= 0:
            w.x[hit] = w.high[hit] if w.step[hit] > 0.0 else w.low[hit]
            w.bound[hit] = 1.0
            continue
        left = costliest_bound(w)
        if left < 0:
            break
        w.bound[left] = 0.0


@compilable
def gradient(w: Program, i: int) -> float:
    """Gradient of the program at x, in the direction of an unknown."""
    found = w.slope[i]
    for j in range(SIZE):
        found += (w.hessian[i * SIZE + j] if j <= i else w.hessian[j * SIZE + i]) * w.x[j]
    return found


@compilable
def costliest_bound(w: Program) -> int:
    """The unknown that would gain most by leaving its bound, -1 if none would."""
    worst = -1
    most = largest = 0.0
    for i in range(SIZE):
        slope = gradient(w, i)
        largest = max(largest, abs(w.slope[i]))
        if w.bound[i] == 1.0 and w.low[i] < w.high[i]:
            # At the lower bound only growth is allowed, which pays where the gradient is negative.
            gain = -slope if w.x[i] == w.low[i] else slope
            if gain > most:
                worst, most = i, gain
    return worst if most > _CLOSE * largest else -1


@compilable
def towards_least(w: Program) -> None:
    """Set the step to the least of the free unknowns, H d = -g, by Cholesky."""
    n = SIZE
    for i in range(n):
        for j in range(i + 1):
            # An unknown at a bound gets a row of the identity, and no right side: its step is none.
            free = w.bound[i] == 0.0 and w.bound[j] == 0.0
            value = w.hessian[i * n + j] if free else (1.0 if i == j else 0.0)
            for k in range(j):
                value -= w.factor[i * n + k] * w.factor[j * n + k]
            w.factor[i * n + j] = sqrt(value) if i == j else value / w.factor[j * n + j]
    for i in range(n):
        value = -gradient(w, i) if w.bound[i] == 0.0 else 0.0
        for k in range(i):
            value -= w.factor[i * n + k] * w.step[k]
        w.step[i] = value / w.factor[i * n + i]
    for i in range(n - 1, -1, -1):
        value = w.step[i]
        for k in range(i + 1, n):
            value -= w.factor[k * n + i] * w.step[k]
        w.step[i] = value / w.factor[i * n + i]
