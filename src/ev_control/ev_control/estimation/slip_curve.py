"""The curve y = A x + B g(x) through the samples of a window, its slope and its peak (dissertation, eq 2.36)."""

from __future__ import annotations

from dataclasses import dataclass
from math import inf
from typing import NamedTuple

from ev_control.estimation.slip_curve_fit import SQUARE, TEMPLATES, SlipCurveFit, samples_in
from ev_core.law import compilable, parameter, sqrt


@dataclass(frozen=True, slots=True)
class SlipCurveParameters:
    """The template of the curve, and how well it has to fit."""

    template: str = parameter(
        "root",
        choices=TEMPLATES,
        about="root: A x + B sqrt(x); square: A x + B x^2",
        source="dissertation, eq 2.36: root; the text beside it, after the patent EP0630786A1: square",
    )
    largest_error: float = parameter(
        0.0,
        unit="1",
        low=0.0,
        high=1e6,
        about="largest sum of squared errors F of a fit that counts; 0 asks for none, because F grows with the "
        "window and with noise",
        source="dissertation, section 2.4: F <= 0.001; not used by default: assumption",
    )


class SlipCurve(NamedTuple):
    """The coefficients of y = A x + B g(x) [1]; both zero where the samples do not tell them apart."""

    a: float
    b: float


@compilable
def fitted_curve(fit: SlipCurveFit) -> SlipCurve:
    """The curve of the least squared error."""
    sum_of_roots = fit.sum_roots if fit.template == SQUARE else fit.sum_x + samples_in(fit) * fit.offset
    determinant = fit.sum_xx * sum_of_roots - fit.sum_x_root * fit.sum_x_root
    if determinant <= 1e-9 * fit.sum_xx * sum_of_roots:
        return SlipCurve(0.0, 0.0)
    a = (fit.sum_xy * sum_of_roots - fit.sum_root_y * fit.sum_x_root) / determinant
    b = (fit.sum_xx * fit.sum_root_y - fit.sum_x_root * fit.sum_xy) / determinant
    return SlipCurve(a, b)


@compilable
def fits(p: SlipCurveParameters, fit: SlipCurveFit, curve: SlipCurve) -> bool:
    """Whether the squared errors of its best curve sum up to no more than is allowed."""
    error = fit.sum_yy - curve.a * fit.sum_xy - curve.b * fit.sum_root_y
    return p.largest_error == 0.0 or error <= p.largest_error


@compilable
def slope(fit: SlipCurveFit, curve: SlipCurve, x: float) -> float:
    """dy/dx of a curve at a slip [1], above zero for the root without offset."""
    if fit.template == SQUARE:
        return curve.a + 2.0 * curve.b * x
    return curve.a + curve.b / (2.0 * sqrt(x + fit.offset))


@compilable
def fitted_peak(p: SlipCurveParameters, fit: SlipCurveFit) -> float:
    """Slip at which the fitted curve turns down, (B/(2 A))^2 or -A/(2 B) [1]; infinite where it rises throughout.

    It is infinite as well where the curve does not fit, or the samples do not tell its coefficients apart.
    """
    curve = fitted_curve(fit)
    if not fits(p, fit, curve):
        return inf
    if fit.template == SQUARE:
        if curve.b >= 0.0:
            return inf if curve.a >= 0.0 else 0.0
        return max(curve.a / (-2.0 * curve.b), 0.0)
    if curve.a >= 0.0:
        return inf
    if curve.b <= 0.0:
        return 0.0
    z = curve.b / (2.0 * curve.a)
    return max(z * z - fit.offset, 0.0)
