"""Least squares of y = A x + B g(x) over the last samples (dissertation, eq 2.36).

g(x) is sqrt(x) in the equations, and x^2 in the text, which names the template of the patent
EP0630786A1. The rounding errors of the sums are added up as well, so that hardly anything of them
is left: a sum is the pair of its value and of what rounding has lost of it, and begins at
`EMPTY_SUM`.
"""

from dataclasses import dataclass
from enum import auto
from math import inf
from typing import Any, NamedTuple

from ev_core.law import Choice, compilable, entry, parameter, series, sqrt

EMPTY_SUM = (0.0, 0.0)
CAPACITY = 1000  # samples: 5 s at 5 ms, 2 s at 2 ms; a window that would hold more is cut to it


class Template(Choice):
    """Forms of the curve."""

    ROOT = auto()
    SQUARE = auto()


@compilable
def plus(total: tuple[float, float], number: float) -> tuple[float, float]:
    """Sum with one more number and its exact error (Knuth's two-sum)."""
    before, lost = total
    value = before + number
    taken = value - before
    return value, lost + ((before - (value - taken)) + (number - taken))


@compilable
def rounded(total: tuple[float, float]) -> float:
    """The sum, rounded once."""
    return total[0] + total[1]


@dataclass(slots=True)
class SlipCurveFit:
    """The last samples in a ring, and the sums of the normal equations over the window.

    The square root is taken of x + `offset`: its slope at zero stays finite, and x = 0 does no
    harm. x below zero counts as zero. A sum that gains and loses a sample each time collects
    rounding errors, so it is formed again after each window, and at once when the window or the
    offset is another one.
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


@compilable
def shape(x: float, offset: float, template: float) -> float:
    """The second function of the template, g(x) [1]."""
    return x * x if template == Template.SQUARE else sqrt(x + offset)


@compilable
def add_sample(
    fit: SlipCurveFit, size: float, offset: float, x: float, y: float, template: Any = 0.0
) -> None:
    """Take one sample in, and the oldest one out where the window of this size is full."""
    x = max(x, 0.0)
    size = min(size, float(CAPACITY))
    is_changed = size != fit.size or offset != fit.offset or template != fit.template
    fit.size = size
    fit.offset = offset
    fit.template = template
    old_x = old_y = old_root = 0.0
    if is_full(fit):
        # Read before the newest sample is written, which takes its place in the longest window.
        oldest = int(fit.taken - size) % CAPACITY
        old_x, old_y = fit.x[oldest], fit.y[oldest]
        old_root = shape(old_x, offset, template)
    newest = int(fit.taken) % CAPACITY
    fit.x[newest], fit.y[newest] = x, y
    fit.taken += 1.0
    # Now and then from scratch, because rounding errors collect.
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
    taken = int(fit.taken)
    all_x, all_y = fit.x, fit.y
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
    """Number of samples in the window so far [1]."""
    return min(fit.taken, fit.size)


@compilable
def is_full(fit: SlipCurveFit) -> bool:
    """Return true if the window has all its samples."""
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


@dataclass(frozen=True, slots=True)
class SlipCurveParameters:
    """The template of the curve, and how well it has to fit."""

    template: Template = parameter(
        Template.ROOT,
        about="root: A x + B sqrt(x); square: A x + B x^2",
        source="dissertation, eq 2.36: root; the text beside it, after the patent EP0630786A1: "
        "square",
    )
    largest_error: float = parameter(
        0.0,
        unit="1",
        low=0.0,
        high=1e6,
        about="largest sum of squared errors F of a fit that counts; 0 asks for none, because F "
        "grows with the window and with noise",
        source="dissertation, section 2.4: F <= 0.001; not used by default: assumption",
    )


class FittedCurve(NamedTuple):
    """Coefficients of y = A x + B g(x) [1]; both zero if the samples do not distinguish them."""

    a: float
    b: float


@compilable
def fitted_curve(fit: SlipCurveFit) -> FittedCurve:
    """The curve of the least squared error."""
    # The square of the root is x + offset, so its sum follows from that of x.
    sum_of_roots = fit.sum_x + samples_in(fit) * fit.offset
    if fit.template == Template.SQUARE:
        sum_of_roots = fit.sum_roots
    determinant = fit.sum_xx * sum_of_roots - fit.sum_x_root * fit.sum_x_root
    # All samples at one slip: any curve through them fits.
    if determinant <= 1e-9 * fit.sum_xx * sum_of_roots:
        return FittedCurve(0.0, 0.0)
    a = (fit.sum_xy * sum_of_roots - fit.sum_root_y * fit.sum_x_root) / determinant
    b = (fit.sum_xx * fit.sum_root_y - fit.sum_x_root * fit.sum_xy) / determinant
    return FittedCurve(a, b)


@compilable
def fits(p: SlipCurveParameters, fit: SlipCurveFit, curve: FittedCurve) -> bool:
    """Return true if the squared errors of its best curve sum up to no more than allowed."""
    # This short form holds for the coefficients of the least squares alone.
    error = fit.sum_yy - curve.a * fit.sum_xy - curve.b * fit.sum_root_y
    return p.largest_error == 0.0 or error <= p.largest_error


@compilable
def slope(fit: SlipCurveFit, curve: FittedCurve, x: float) -> float:
    """dy/dx of a curve at a slip [1], above zero for the root without offset."""
    if fit.template == Template.SQUARE:
        return curve.a + 2.0 * curve.b * x
    return curve.a + curve.b / (2.0 * sqrt(x + fit.offset))


@compilable
def fitted_peak(p: SlipCurveParameters, fit: SlipCurveFit) -> float:
    """Slip [1] at which the fitted curve turns down, (B/(2 A))^2 or -A/(2 B).

    It is infinite where the curve rises throughout, where it does not fit, and where the samples do
    not distinguish its coefficients.
    """
    curve = fitted_curve(fit)
    if not fits(p, fit, curve):
        return inf
    if fit.template == Template.SQUARE:
        # A x + B x^2 turns down with B < 0 only; with A < 0 it falls from the very beginning.
        if curve.b >= 0.0:
            return inf if curve.a >= 0.0 else 0.0
        return max(curve.a / (-2.0 * curve.b), 0.0)
    # A x + B sqrt(x + e): both parts rise with A >= 0 and B > 0, both fall with A < 0 and B <= 0.
    if curve.a >= 0.0:
        return inf
    if curve.b <= 0.0:
        return 0.0
    z = curve.b / (2.0 * curve.a)
    return max(z * z - fit.offset, 0.0)
