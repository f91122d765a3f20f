"""A closed course: the middle of its road, its width, and the number of laps.

How it works: a course is checked as it is declared: the distances of its points, and edges that do
not fold. One from a file is first moved to the middle of its road, and turned to begin at the
origin along x.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from ev_core.law import ParameterError, cos, parameter, setting, sin
from ev_core.parameters.data_file import read_csv
from ev_core.parameters.declaration import flatten
from ev_core.parameters.values import build

_COLUMNS = (
    {"x_m": 1.0},
    {"y_m": 1.0},
    {"left_m": 1.0, "w_tr_left_m": 1.0},
    {"right_m": 1.0, "w_tr_right_m": 1.0},
)
_FEWEST, _MOST = 12, 5000  # points
_NEAREST, _FARTHEST = 0.5, 20.0  # [m], from one point to the next
_SAME = 0.01  # [m]: a last point that repeats the first one, as some files close a course
_RADIUS, _CHORDS = 30.0, 24  # of the circle that is there without a file
_TURNS = [2.0 * math.pi * n / _CHORDS for n in range(_CHORDS)]


@dataclass(frozen=True, slots=True)
class CourseParameters:
    """A closed course in odom, from its first point on.

    The line across the first point times the laps. The course of a file is placed so that this
    point is the origin and the course leads along x there.
    """

    file: str = setting(
        "",
        about="CSV file with the columns x_m, y_m of a line along the course and left_m, right_m "
        "from it to the edges "
        "(or w_tr_left_m, w_tr_right_m), instead of x, y and width; empty for none",
    )
    x: tuple[float, ...] = setting(
        tuple(_RADIUS * sin(turn) for turn in _TURNS),
        unit="m",
        low=-1e5,
        high=1e5,
        about="middle of the road",
    )
    y: tuple[float, ...] = setting(
        tuple(_RADIUS * (1.0 - cos(turn)) for turn in _TURNS),
        unit="m",
        low=-1e5,
        high=1e5,
        about="middle of the road",
        lateral=True,
    )
    width: tuple[float, ...] = setting(
        (8.0,) * _CHORDS, unit="m", low=1.0, high=100.0, about="of the road there"
    )
    laps: int = setting(1, unit="1", low=1, high=100, about="after which the driver stops")
    clearance: float = parameter(
        0.4,
        unit="m",
        low=0.0,
        high=10.0,
        about="that the racing line leaves between the outer wheel and the edge",
    )

    def __post_init__(self) -> None:
        if not len(self.x) == len(self.y) == len(self.width):
            raise ParameterError("x, y and width need the same number of elements")
        _refuse_number(len(self.x))
        points = list(zip(self.x, self.y, strict=True))
        for number, (one, other) in enumerate(pairwise([*points, points[0]])):
            distance = math.dist(one, other)
            if not _NEAREST <= distance <= _FARTHEST:
                after = (
                    f"{number + 2}"
                    if number + 1 < len(points)
                    else "the first one, with which it closes,"
                )
                raise ParameterError(
                    f"point {after} is {distance:.3g} m behind the one before, expected "
                    f"{_NEAREST:g} to {_FARTHEST:g} m"
                )
        _refuse_folds(self)


def with_course_from_file(parameters: CourseParameters) -> CourseParameters:
    """The course with `x`, `y` and `width` from `file` in place of the file's name, placed in odom.

    Raises ParameterError, in one line that names the file, if it cannot be read (`read_csv`) or
    holds no course.
    """

    def course(*columns: tuple[float, ...]) -> CourseParameters:
        x, y = columns[:2]
        if len(x) > 1 and math.dist((x[0], y[0]), (x[-1], y[-1])) < _SAME:
            columns = tuple(column[:-1] for column in columns)
        _refuse_number(len(columns[0]))
        for number, widths in enumerate(zip(*columns[2:], strict=True)):
            if min(widths) < 0.0:
                raise ParameterError(
                    f"point {number + 1}: a width of {min(widths):g} m is refused, expected 0 or "
                    f"more"
                )
        with np.errstate(all="ignore"):  # what overflows is out of range
            placed = _placed(*columns)
        return build(CourseParameters, {**flatten(parameters), "file": "", **placed})

    return (
        read_csv("course.file", parameters.file, _COLUMNS, course)
        if parameters.file
        else parameters
    )


def _placed(
    x: tuple[float, ...], y: tuple[float, ...], left: tuple[float, ...], right: tuple[float, ...]
) -> dict[str, tuple[float, ...]]:
    """Move the middle of a road to begin at the origin, along x.

    It is found from a line along the road and the widths on both sides.
    """
    line = np.array((x, y)).T
    across = normals(line)
    middle = line + across * (0.5 * (np.array(left) - np.array(right)))[:, None]
    # The normal (-sin, cos) of the first point holds the heading there, by which all is turned
    # back.
    moved, (minus_sine, cosine) = middle - middle[0], normals(middle)[0]
    return {
        "x": tuple((moved[:, 0] * cosine - moved[:, 1] * minus_sine).tolist()),
        "y": tuple((moved[:, 1] * cosine + moved[:, 0] * minus_sine).tolist()),
        "width": tuple((np.array(left) + np.array(right)).tolist()),
    }


def middle_of(course: CourseParameters) -> np.ndarray:
    """The points of the middle of the road, (n, 2) [m]."""
    return np.array((course.x, course.y)).T


def lengths_to_next(points: np.ndarray) -> np.ndarray:
    """Length from each point of a closed line (n, 2) to the next one, (n,) [m]."""
    leg = np.roll(points, -1, axis=0) - points
    return np.sqrt(leg[:, 0] * leg[:, 0] + leg[:, 1] * leg[:, 1])


def normals(points: np.ndarray) -> np.ndarray:
    """Unit vectors to the left of a closed line (n, 2) at its points, (n, 2).

    Each is across the chord of the neighbours.
    """
    along = np.roll(points, -1, axis=0) - np.roll(points, 1, axis=0)
    length = np.sqrt(along[:, 0] * along[:, 0] + along[:, 1] * along[:, 1])
    return np.stack((-along[:, 1], along[:, 0]), axis=1) / np.maximum(length, 1e-9)[:, None]


def edges(course: CourseParameters) -> tuple[np.ndarray, np.ndarray]:
    """The left and the right edge of the road, (n, 2) each [m]."""
    middle = middle_of(course)
    aside = normals(middle) * (0.5 * np.array(course.width))[:, None]
    return middle + aside, middle - aside


def _refuse_folds(course: CourseParameters) -> None:
    """Refuse a road wider than its bend has room for: its edge would run backwards."""
    leg = np.roll(middle_of(course), -1, axis=0) - middle_of(course)
    for side, edge in zip(("left", "right"), edges(course), strict=True):
        on = np.roll(edge, -1, axis=0) - edge
        # An edge must lead the way of the middle of the road, leg by leg.
        if (folds := np.flatnonzero((on * leg).sum(axis=1) <= 0.0)).size:
            raise ParameterError(
                f"point {folds[0] + 1}: the {side} edge runs backwards, the road is wider than its "
                f"bend has room for"
            )


def _refuse_number(points: int) -> None:
    if not _FEWEST <= points <= _MOST:
        raise ParameterError(f"{points} points are no course, expected {_FEWEST} to {_MOST}")
