"""Coefficients of the Magic Formula 6.1 from rig data: each force alone, then what both take from each other.

How it works: four fits follow each other. Side force and longitudinal force are fitted to the
sweeps with one slip alone, then the weights of combined slip to the others, with the coefficients
of the pure forces as they are by then. A prior about the starts makes each fit solvable whatever
the sweeps lack; a coefficient that stays half as wide as the prior is named as undecided.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
from scipy.optimize import least_squares

from ev_study.measured.magic_formula import (
    Points,
    combined_lateral,
    combined_longitudinal,
    lateral,
    longitudinal,
)
from ev_study.measured.rig import Sweeps

# By step of the fit each coefficient with its start, least and largest value. What is not here is
# fixed (FIXED).
_LATERAL = {
    **{
        "PCY1": (1.4, 1.0, 2.5),
        "PDY1": (1.5, 0.1, 5.0),
        "PDY2": (-0.1, -2.0, 2.0),
        "PDY3": (0.0, -20.0, 20.0),
    },
    **{
        "PEY1": (-0.5, -20.0, 1.0),
        "PEY2": (0.0, -20.0, 20.0),
        "PEY3": (0.0, -5.0, 5.0),
        "PEY4": (0.0, -50.0, 50.0),
    },
    **{"PKY1": (-30.0, -200.0, -1.0), "PKY2": (1.5, 0.1, 20.0), "PKY3": (0.0, -5.0, 5.0)},
    **{"PKY6": (-1.0, -10.0, 10.0), "PKY7": (0.0, -10.0, 10.0)},
    **{
        "PHY1": (0.0, -0.05, 0.05),
        "PHY2": (0.0, -0.05, 0.05),
        "PVY1": (0.0, -0.2, 0.2),
        "PVY2": (0.0, -0.2, 0.2),
    },
    **{
        "PVY3": (0.0, -5.0, 5.0),
        "PVY4": (0.0, -5.0, 5.0),
        "PPY1": (0.0, -3.0, 3.0),
        "PPY2": (0.0, -3.0, 3.0),
    },
    **{"PPY3": (0.0, -3.0, 3.0), "PPY4": (0.0, -3.0, 3.0), "PPY5": (0.0, -3.0, 3.0)},
}
_LONGITUDINAL = {
    **{
        "PCX1": (1.5, 1.0, 2.5),
        "PDX1": (1.5, 0.1, 5.0),
        "PDX2": (-0.1, -2.0, 2.0),
        "PDX3": (0.0, -20.0, 20.0),
    },
    **{
        "PEX1": (0.0, -20.0, 1.0),
        "PEX2": (0.0, -20.0, 20.0),
        "PEX3": (0.0, -20.0, 20.0),
        "PEX4": (0.0, -1.0, 1.0),
    },
    **{"PKX1": (40.0, 1.0, 200.0), "PKX2": (0.0, -100.0, 100.0), "PKX3": (0.0, -2.0, 2.0)},
    **{
        "PHX1": (0.0, -0.05, 0.05),
        "PHX2": (0.0, -0.05, 0.05),
        "PVX1": (0.0, -0.2, 0.2),
        "PVX2": (0.0, -0.2, 0.2),
    },
    **{
        "PPX1": (0.0, -3.0, 3.0),
        "PPX2": (0.0, -3.0, 3.0),
        "PPX3": (0.0, -3.0, 3.0),
        "PPX4": (0.0, -3.0, 3.0),
    },
}
_COMBINED_X = {
    **{"RBX1": (10.0, 0.1, 100.0), "RBX2": (8.0, -100.0, 100.0), "RBX3": (0.0, -100.0, 100.0)},
    **{"RCX1": (1.1, 0.3, 2.0), "RHX1": (0.0, -0.05, 0.05)},
}
_COMBINED_Y = {
    **{"RBY1": (10.0, 0.1, 100.0), "RBY2": (8.0, -100.0, 100.0), "RBY3": (0.0, -0.2, 0.2)},
    **{"RBY4": (0.0, -100.0, 100.0)},
    **{"RCY1": (1.1, 0.3, 2.0), "RHY1": (0.0, -0.1, 0.1), "RHY2": (0.0, -0.1, 0.1)},
    **{
        "RVY1": (0.0, -1.0, 1.0),
        "RVY2": (0.0, -1.0, 1.0),
        "RVY3": (0.0, -10.0, 10.0),
        "RVY4": (10.0, 0.0, 100.0),
    },
    **{"RVY5": (1.9, 0.1, 3.0), "RVY6": (10.0, -100.0, 100.0)},
}
STARTS = {**_LATERAL, **_LONGITUDINAL, **_COMBINED_X, **_COMBINED_Y}
# What a property file means that leaves them out: a PKY4 of 2, as in `ev_core.vehicle.tyre`.
FIXED = {"PKY4": 2.0, "PKY5": 0.0, "PEY5": 0.0, "REX1": 0.0, "REX2": 0.0, "REY1": 0.0, "REY2": 0.0}
# samples of each sweep that the fit sees, evenly spread: they are far closer than a tyre can change
PER_SWEEP = 60
BELIEVED = 0.02  # of the largest force, RMS: what the formula is off by, as a measure of what sweeps decide
PRIOR = 0.25  # of its range, standard deviation of what is believed of a coefficient before the fit
REACHED = (
    0.9  # of the largest force that the curve has at its load: a sweep beyond that shows friction
)
# By force alone the slip over which friction is looked for, and how far.
_FURTHEST = {"lateral": ("slip_angle", np.radians(30.0)), "longitudinal": ("slip_ratio", 1.0)}
UNDECIDED = 0.5  # of that, above which a coefficient is an assumption after it as well
KINDS = ("lateral", "longitudinal", "combined longitudinal", "combined lateral")


@dataclass(frozen=True)
class TyreFit:
    """The coefficients, and by kind of force the RMS error over the largest force, of seen and of unseen sweeps.

    `at_start` names the coefficients of forces that no sweep has, `undecided` those that the sweeps
    hardly change: friction that no slip angle reaches, loads, inclinations and pressures that do
    not differ. Both are assumptions.
    """

    coefficients: Mapping[str, float]
    seen: Mapping[str, float]
    unseen: Mapping[str, float]
    at_start: tuple[str, ...] = ()
    undecided: tuple[str, ...] = ()


def is_held_out(number: np.ndarray) -> np.ndarray:
    """Mask of the sweeps, by their numbers, that a fit does not see: every third one."""
    return number % 3 == 2


def fit_tyre(sweeps: Sweeps) -> TyreFit:
    """Fit to all sweeps but those that are held out.

    What a kind of sweep is not there for stays at its start.
    """
    points = sweeps.points
    nominal = {
        "FNOMIN": float(np.median(points.load)),
        "NOMPRES": float(np.median(points.pressure)),
    }
    # Whatever is not fitted below keeps these values, so a property file is complete in any case.
    found = {**FIXED, **nominal, **{name: start for name, (start, _, _) in STARTS.items()}}
    unseen = is_held_out(sweeps.number)
    along, across = points.longitudinal_force, points.lateral_force
    both = ~sweeps.is_lateral & ~sweeps.is_longitudinal
    # The order matters: the weights of combined slip multiply the pure forces that were fitted
    # before.
    steps = dict(
        zip(
            KINDS,
            (
                (_LATERAL, lateral, across, sweeps.is_lateral),
                (_LONGITUDINAL, longitudinal, along, sweeps.is_longitudinal),
                (_COMBINED_X, combined_longitudinal, along, both),
                (_COMBINED_Y, combined_lateral, across, both),
            ),
            strict=True,
        )
    )
    seen_errors, unseen_errors = {}, {}
    at_start: list[str] = []
    undecided: list[str] = []
    for kind, (free, model, force, chosen) in steps.items():
        # No sweep of this kind, or only some that are held out.
        if not (chosen & ~unseen).any():
            at_start += free
            continue
        # Of the sweeps that are seen only; errors below are of all their samples.
        thin = _thinned(sweeps.number, chosen & ~unseen)
        values, deviations = _fitted(free, model, found, points.some(thin), force[thin])
        # On a straight piece of the curve friction and shape take each other's place: they stay at
        # the start, and the stiffness is fitted once more without them.
        if kind in _FURTHEST and not _reaches_friction(
            model, found | values, kind, points.some(thin)
        ):
            # What bends the curve, in a coefficient's second letter: shape, friction, curvature.
            bends = [name for name in free if name[1] in "CDE"]
            undecided += bends
            free = {name: of for name, of in free.items() if name not in bends}
            values, deviations = _fitted(free, model, found, points.some(thin), force[thin])
        found |= values
        undecided += [name for name, of in deviations.items() if of > UNDECIDED * PRIOR]
        # An error of the seen part alone would not show a fit that follows noise.
        for errors, part in ((seen_errors, chosen & ~unseen), (unseen_errors, chosen & unseen)):
            if part.any():
                errors[kind] = _relative(model(found, points.some(part)), force[part])
    return TyreFit(found, seen_errors, unseen_errors, tuple(at_start), tuple(undecided))


def _thinned(number: np.ndarray, chosen: np.ndarray) -> np.ndarray:
    places = np.flatnonzero(chosen)
    sweeps = np.split(places, np.flatnonzero(np.diff(number[places])) + 1)
    return np.concatenate(
        [s[np.linspace(0, len(s) - 1, min(PER_SWEEP, len(s))).astype(int)] for s in sweeps]
    )


def _fitted(
    free: Mapping[str, tuple[float, float, float]],
    model: Callable[[Mapping[str, float], Points], np.ndarray],
    others: Mapping[str, float],
    points: Points,
    force: np.ndarray,
) -> tuple[dict[str, float], dict[str, float]]:
    """Coefficients, and the standard deviation of each in shares of its range.

    Least squares with a loss that does not follow outliers beyond a tenth of the largest force. A
    prior about the starts keeps what the samples do not decide: one load fits any friction over
    load.
    """
    starts, lows, highs = np.array(list(free.values())).T
    largest = float(np.max(np.abs(force)))
    # A coefficient that is off by PRIOR of its range costs as much as one force off by BELIEVED.
    weights = BELIEVED / (PRIOR * (highs - lows))

    # Forces over the largest one, so that one threshold of the loss fits tyres of all sizes.
    def errors(values: np.ndarray) -> np.ndarray:
        coefficients = {**others, **dict(zip(free, values, strict=True))}
        of_force = (model(coefficients, points) - force) / largest
        return np.concatenate([of_force, weights * (values - starts)])

    # Many starts are 0, which is no size of a step; very wide ranges are cut to 2 for the same
    # reason.
    scale = np.maximum(np.abs(starts), 0.05 * np.minimum(highs - lows, 2.0))
    ends = (lows, highs)
    found = least_squares(
        errors, starts, bounds=ends, x_scale=scale, loss="soft_l1", f_scale=0.1, max_nfev=200
    )
    # The prior has rows of its own in the Jacobian, so this is never singular.
    covariance = np.linalg.inv(found.jac.T @ found.jac)
    deviations = BELIEVED * np.sqrt(np.diag(covariance)) / (highs - lows)
    values = dict(zip(free, found.x.tolist(), strict=True))
    return values, dict(zip(free, deviations.tolist(), strict=True))


def _reaches_friction(
    model: Callable[[Mapping[str, float], Points], np.ndarray],
    coefficients: Mapping[str, float],
    kind: str,
    points: Points,
) -> bool:
    """Return True if a point has nearly as much force as a curve has at its load."""
    slip, furthest = _FURTHEST[kind]
    # Of the fitted curve, not of the data: these may end below its peak, which is the question.
    most = np.zeros(len(points.load))
    for each in np.linspace(-furthest, furthest, 61):
        moved = replace(points, **{slip: np.full(len(most), each)})
        most = np.maximum(most, np.abs(model(coefficients, moved)))
    return bool((np.abs(model(coefficients, points)) > REACHED * most).any())


def _relative(model: np.ndarray, force: np.ndarray) -> float:
    return float(np.sqrt(np.mean((model - force) ** 2)) / np.max(np.abs(force)))
