"""Write config/courses/handling.csv: a closed course through a few points, drawn by hand for this project.

python tools/handling_course.py FILE
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
from scipy.interpolate import CubicSpline

STEP, HALF_WIDTH = 2.0, 3.5  # [m]
# [m]: a straight, a fast bend of about 55 m, a chicane, and three hairpins of 10 to 14 m, driven
# against the clock.
THROUGH = """0 0, 45 0, 90 0, 130 3, 165 18, 188 45, 192 78, 178 106, 150 122, 118 122, 92 114, 68 122, 44 132,
18 126, -8 118, -40 122, -70 118, -86 102, -84 84, -66 76, -40 78,
-12 74, 4 60, 0 46, -18 38, -50 36, -74 28, -78 12, -62 1, -30 0"""


def points() -> np.ndarray:
    """The middle of the road, a closed cubic spline (n, 2) at equal lengths of about STEP [m]."""
    corners = np.array([each.split() for each in THROUGH.split(",")], float)
    corners = np.vstack((corners, corners[:1]))
    along = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(corners, axis=0).T))))
    fine = CubicSpline(along, corners, bc_type="periodic")(np.linspace(0.0, along[-1], 20_001))
    length = np.concatenate(([0.0], np.cumsum(np.hypot(*np.diff(fine, axis=0).T))))
    at = np.linspace(0.0, length[-1], round(length[-1] / STEP), endpoint=False)
    return np.stack([np.interp(at, length, of) for of in fine.T], axis=1)


def main() -> None:
    """Write the file of the first argument."""
    rows = [f"{x + 0.0:.3f},{y + 0.0:.3f},{HALF_WIDTH},{HALF_WIDTH}" for x, y in points().round(3)]
    Path(sys.argv[1]).write_text("\n".join(["x_m,y_m,left_m,right_m", *rows, ""]))


if __name__ == "__main__":
    main()
