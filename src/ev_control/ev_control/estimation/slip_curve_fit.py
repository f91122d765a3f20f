"""Least squares of the curve y = A x + B g(x) over the last samples (dissertation, eq 2.36).

g(x) = sqrt(x) in the equations; x^2 in the text, which names the template of the patent EP0630786A1.

Sums whose rounding errors are added up as well, so that hardly anything of them is left.
A sum is the pair of its value and of what rounding has lost of it; `EMPTY_SUM` is where it begins.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from ev_control.estimation.first_order_filter import start_again
from ev_core.law import compilable, entry, series, sqrt

EMPTY_SUM = (0.0, 0.0)


@compilable
def plus(total: tuple[float, float], number: float) -> tuple[float, float]:
    """The sum with one more number; the error of one addition is exactly a number (Knuth's two-sum)."""
    before, lost = total
    value = before + number
    taken = value - before
    return value, lost + ((before - (value - taken)) + (number - taken))


@compilable
def rounded(total: tuple[float, float]) -> float:
    """The sum, rounded once."""
    return total[0] + total[1]


TEMPLATES = ("root", "square")
ROOT, SQUARE = range(len(TEMPLATES))
CAPACITY = 1000  # samples: 5 s at 5 ms, 2 s at 2 ms; a window that would hold more is cut to it


@dataclass(slots=True)
class SlipCurveFit:
    """The last samples in a ring, and the sums of the normal equations over the window.

    The square root is taken of x + `offset`: its slope at zero stays finite, and x = 0 does no harm. x below zero
    counts as zero. A sum that gains and loses a sample each time collects rounding errors, so it is formed anew after
    each window, and at once when the window or the offset is another one.
    """

    x: list[float] = series(CAPACITY, unit="1", about="slip")
    y: list[float] = series(CAPACITY, unit="1", about="torque over its nominal value")
    taken: float = entry(unit="1", about="samples so far")
    size: float = entry(unit="1", about="samples in the window; zero before the first one")
    offset: float = entry(unit="1", about="added to the slip under the square root")
    template: float = entry(unit="1", about="0 for the root, 1 for the square")
    sum_x: float = entry(unit="1")
    sum_xx: float = entry(unit="1")
    sum_x_root: float = entry(unit="1")
    sum_xy: float = entry(unit="1")
    sum_root_y: float = entry(unit="1", about="here and below the root stands for g(x)")
    sum_roots: float = entry(unit="1", about="of g^2, where that is not x + offset")
    sum_yy: float = entry(unit="1")


forget_samples = start_again(SlipCurveFit)


@compilable
def shape(x: float, offset: float, template: float) -> float:
    """The second function of the template, g(x) [1]."""
    return x * x if template == SQUARE else sqrt(x + offset)


@compilable
def add_sample(fit: SlipCurveFit, size: float, offset: float, x: float, y: float, template: Any = 0.0) -> None:
    """Take one sample in, and the oldest one out where the window of this size is full."""
    x, size = max(x, 0.0), min(size, float(CAPACITY))
    is_changed = size != fit.size or offset != fit.offset or template != fit.template
    fit.size, fit.offset, fit.template = size, offset, template
    old_x = old_root = old_y = 0.0
    if is_full(fit):
        oldest = int(fit.taken - size) % CAPACITY
        old_x, old_y = fit.x[oldest], fit.y[oldest]
        old_root = shape(old_x, offset, template)
    newest = int(fit.taken) % CAPACITY
    fit.x[newest], fit.y[newest] = x, y
    fit.taken += 1.0
    if is_changed or (fit.taken > size and fit.taken % size == 0.0):
        sum_anew(fit)
        return
    root = shape(x, offset, template)
    fit.sum_x = fit.sum_x - old_x + x
    fit.sum_xx = fit.sum_xx - old_x * old_x + x * x
    fit.sum_x_root = fit.sum_x_root - old_x * old_root + x * root
    fit.sum_xy = fit.sum_xy - old_x * old_y + x * y
    fit.sum_root_y = fit.sum_root_y - old_root * old_y + root * y
    fit.sum_roots = fit.sum_roots - old_root * old_root + root * root
    fit.sum_yy = fit.sum_yy - old_y * old_y + y * y


@compilable
def sum_anew(fit: SlipCurveFit) -> None:
    """Form all sums over the window."""
    sum_x = sum_xx = sum_x_root = sum_xy = sum_root_y = sum_roots = sum_yy = EMPTY_SUM
    all_x, all_y, taken = fit.x, fit.y, int(fit.taken)
    for place in range(taken - int(samples_in(fit)), taken):
        x, y = all_x[place % CAPACITY], all_y[place % CAPACITY]
        root = shape(x, fit.offset, fit.template)
        sum_x = plus(sum_x, x)
        sum_xx = plus(sum_xx, x * x)
        sum_x_root = plus(sum_x_root, x * root)
        sum_xy = plus(sum_xy, x * y)
        sum_root_y = plus(sum_root_y, root * y)
        sum_roots = plus(sum_roots, root * root)
        sum_yy = plus(sum_yy, y * y)
    fit.sum_x = rounded(sum_x)
    fit.sum_xx = rounded(sum_xx)
    fit.sum_x_root = rounded(sum_x_root)
    fit.sum_xy = rounded(sum_xy)
    fit.sum_root_y = rounded(sum_root_y)
    fit.sum_roots = rounded(sum_roots)
    fit.sum_yy = rounded(sum_yy)


@compilable
def samples_in(fit: SlipCurveFit) -> float:
    """How many samples the window holds so far."""
    return min(fit.taken, fit.size)


@compilable
def is_full(fit: SlipCurveFit) -> bool:
    """Whether the window has all its samples."""
    return fit.taken >= fit.size


@compilable
def mean_slip(fit: SlipCurveFit) -> float:
    """Mean slip [1] of a full window."""
    return fit.sum_x / fit.size


@compilable
def slip_variance(fit: SlipCurveFit) -> float:
    """Mean squared deviation of the slip [1] of a full window."""
    mean = fit.sum_x / fit.size
    return fit.sum_xx / fit.size - mean * mean
