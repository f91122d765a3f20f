"""Certainty of a fit: intervals, and the combinations of parameters that a record cannot tell.

How it works: at the optimum the errors are taken as linear in the parameters. J'J then is what the
record knows of each direction, and its inverse the covariance. Two things make it honest: errors
within a window are not independent, which the gradients of whole windows show, and windows differ,
which the bootstrap shows. The wider of both counts.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.special import stdtrit

from ev_study.measured.free_parameters import FreeParameter

# 2.5 % of them are 25 beyond each end.
DRAWS = 1000
LEVEL, NORMAL = 0.95, 1.96  # of an interval, and half its width in standard deviations
# standard deviation, in scales, from which on a direction counts as one that the record cannot tell
UNKNOWN = 0.5


@dataclass(frozen=True)
class Knowledge:
    """Standard deviation (Jacobian) and 95 % interval (bootstrap over windows) by parameter.

    Both are in its unit. `unknown`: each direction that the record cannot tell as shares of scales,
    (directions, parameters), of length 1, and its standard deviation in scales.
    """

    deviation: np.ndarray
    interval: np.ndarray
    unknown: np.ndarray
    unknown_deviation: np.ndarray


def knowledge(
    residuals: np.ndarray,
    derivatives: np.ndarray,
    values: np.ndarray,
    free: Sequence[FreeParameter],
    width: float,
    seed: int,
) -> Knowledge:
    """Knowledge of a fit at its optimum.

    Residuals (windows, m) over their standard deviations and derivatives (windows, m, parameters)
    by scaled parameters. Errors within a window go together, so their number counts for less: the
    covariance (J'J)^-1 is multiplied by the mean ratio of the variance of the gradients of windows
    to that of independent errors. The bootstrap draws windows with replacement and takes one step
    of Gauss and Newton from the optimum in each draw. Draws of n windows are too much alike where
    these are few, so their ends are stretched by the root of n/(n - 1) and by Student's over the
    normal quantile (Hesterberg, The American Statistician 69, 2015, expanded percentile interval).
    An interval reaches at least 1.96 standard deviations far, and ends where the range of the
    parameter does. `width` [scales] is that of the prior about the start, which keeps what the
    record cannot tell.
    """
    windows, _, count = derivatives.shape
    scale = np.array([each.scale for each in free])
    # By window, since a draw of the bootstrap takes whole windows.
    information = np.einsum("wmi,wmj->wij", derivatives, derivatives)
    gradients = np.einsum("wmi,wm->wi", derivatives, residuals)
    # A normal distribution about the start with this deviation, in the same unit as J'J.
    prior = np.eye(count) / width**2
    whole = information.sum(axis=0)
    inverse = np.linalg.inv(whole + prior)
    # Below 1 the errors of a window would cancel each other, which is not taken for certainty.
    together = max(float(np.trace(inverse @ (gradients.T @ gradients))) / count, 1.0)
    # The prior is no error that goes together, so it is not divided.
    covariance = np.linalg.inv(whole / together + prior)
    random = np.random.Generator(np.random.PCG64(seed))
    drawn = random.multinomial(windows, np.full(windows, 1.0 / windows), DRAWS)
    # The gradient of all windows at the optimum is that of the prior and of the loss; it moves no
    # draw.
    centred = gradients - gradients.mean(axis=0)
    steps = [
        -np.linalg.solve(np.tensordot(w, information, 1) + prior, w @ centred)
        for w in drawn.astype(float)
    ]
    drawn_ends = np.quantile(steps, [(1.0 - LEVEL) / 2.0, (1.0 + LEVEL) / 2.0], axis=0)
    by_normal = NORMAL * np.sqrt(np.diag(covariance))
    if windows > 1:
        drawn_ends *= (
            stdtrit(windows - 1, (1.0 + LEVEL) / 2.0) / NORMAL * np.sqrt(windows / (windows - 1.0))
        )
    # Few windows may happen to agree: the draws alone are too narrow then (docs/measured.md).
    ends = np.array([np.minimum(drawn_ends[0], -by_normal), np.maximum(drawn_ends[1], by_normal)])
    # Without the prior: the question is what the record tells by itself.
    sizes, directions = np.linalg.eigh(whole / together)
    # A direction that changes nothing has the size 0, by rounding even less.
    deviations = 1.0 / np.sqrt(np.maximum(sizes, 1e-12))
    chosen = deviations > UNKNOWN
    return Knowledge(
        np.sqrt(np.diag(covariance)) * scale,
        np.clip(values + ends * scale, [e.low for e in free], [e.high for e in free]).T,
        directions.T[chosen],
        deviations[chosen],
    )


def in_words(known: Knowledge, free: Sequence[FreeParameter]) -> list[str]:
    """The directions that a record cannot tell, by the names of the parameters that make up most of each."""
    lines = []
    for direction, deviation in zip(known.unknown, known.unknown_deviation, strict=True):
        # Parameters with less than a tenth (0.3 squared) of a direction do not name it, but the
        # largest one does: many equal parts may all be small.
        order = np.argsort(-np.abs(direction))
        order = [n for n in order if n == order[0] or abs(direction[n]) > 0.3]
        # An eigenvector has no sign of its own: the largest part is written with a plus.
        sign = np.sign(direction[order[0]])
        parts = [f"{'+' if sign * direction[n] > 0 else '-'} {free[n].name}" for n in order]
        what = "alone" if len(parts) == 1 else "together"
        # A direction without any information has a million scales, which is no number to print.
        lines.append(
            f"{' '.join(parts).removeprefix('+ ')} {what}, to {min(deviation, 99.0):.2g} of the"
            " scale"
        )
    return lines
