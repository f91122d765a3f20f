"""Distances of points from a path.

The code is compiled, as bends have hundreds of legs, and called without numba.
"""

from __future__ import annotations

import math

import numpy as np

from ev_core.compiling.machine_code import Code, call
from ev_msgs_py.compilable import compilable
from ev_sim.driver.path import Path, passed_on


@compilable
def _distances(path: Path, x: np.ndarray, y: np.ndarray, found: np.ndarray) -> None:
    last = len(path.x) - 1
    for i in range(len(x)):
        square = math.inf
        for leg in range(last + 1):
            passed = passed_on(path, leg, x[i], y[i])
            # The first leg goes on for ever backwards, the last one forwards.
            if leg > 0:
                passed = max(passed, 0.0)
            if leg < last:
                passed = min(passed, path.length[leg])
            off_x = x[i] - path.x[leg] - passed * path.along_x[leg]
            off_y = y[i] - path.y[leg] - passed * path.along_y[leg]
            square = min(square, off_x * off_x + off_y * off_y)
        found[i] = math.sqrt(square)


DISTANCES = Code(
    "distances",
    '''"""Distances from a path: generated, do not edit."""

from numba import carray, cfunc, types

I, P = types.int64, types.voidptr


@cfunc(types.int32(P, I, P, I), error_model="numpy")
def step(legs, count, points, size):
    of, rows = carray(legs, (6, count), FLOAT), carray(points, (3, size), FLOAT)
    distances(Path(of[0], of[1], of[2], of[3], of[4], of[5]), rows[0], rows[1], rows[2])
    return 0
''',
    {"FLOAT": np.float64, "Path": Path, "distances": _distances},
)


def distances_from(path: Path, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Distances of points (n,) [m] from a path, (n,) [m]; its first and last leg go on for ever."""
    legs, points = np.array(path), np.array([x, y, np.empty(len(x))])
    call(DISTANCES.address(), legs.ctypes.data, legs.shape[1], points.ctypes.data, points.shape[1])
    return points[2]
