"""Dense quadratic programs with bounds by daqp, what our solvers are held against.

Arnström, Bemporad & Axehill (2022), A dual active-set solver for embedded quadratic programming
using recursive LDL' updates, IEEE TAC 67(8).
"""

from __future__ import annotations

import daqp
import numpy as np

_EQUALITY, _OPTIMAL = 5, 1


def by_daqp(
    hessian: np.ndarray, slope: np.ndarray, low: np.ndarray, high: np.ndarray
) -> np.ndarray:
    """Minimise x'Hx/2 + c'x within low <= x <= high; no bound is missed by more than 1e-12."""
    sense = np.where(low == high, _EQUALITY, 0).astype(np.intc)
    no_rows = np.zeros((0, len(slope)))
    tolerances = {"primal_tol": 1e-12, "dual_tol": 1e-12, "eps_prox": 0.0}
    x, _, flag, _ = daqp.solve(hessian, slope, no_rows, high, low, sense, **tolerances)
    assert flag == _OPTIMAL
    return x
