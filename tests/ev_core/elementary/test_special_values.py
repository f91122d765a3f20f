"""Zeros, infinities and NaN as annex F of the C standard has them, and nothing is raised."""

from __future__ import annotations

import math

import pytest
from elementary.precise import ONE, TWO, same

from ev_core import elementary

INF, NAN, PI = math.inf, math.nan, math.pi

ONE_ARGUMENT = [
    *(
        (name, zero, zero)
        for zero in (0.0, -0.0)
        for name in ("sin", "tan", "asin", "atan", "expm1", "log1p")
    ),
    *((name, zero, zero) for zero in (0.0, -0.0) for name in ("sinh", "tanh", "atanh")),
    *((name, zero, 1.0) for zero in (0.0, -0.0) for name in ("cos", "exp", "cosh")),
    *(
        (name, infinity, NAN)
        for infinity in (INF, -INF)
        for name in ("sin", "cos", "tan", "asin", "acos", "atanh")
    ),
    *(
        (name, beyond, NAN)
        for beyond in (1.0000000000000002, -2.0)
        for name in ("asin", "acos", "atanh")
    ),
    *(("acos", 1.0, 0.0), ("acos", -1.0, PI), ("acos", 0.0, PI / 2), ("asin", 1.0, PI / 2)),
    *(("atan", INF, PI / 2), ("atan", -INF, -PI / 2), ("atan", 1e300, PI / 2)),
    *(
        ("exp", INF, INF),
        ("exp", -INF, 0.0),
        ("exp", 710.0, INF),
        ("exp", -746.0, 0.0),
        ("exp", 1.0, math.e),
    ),
    *(("expm1", INF, INF), ("expm1", -INF, -1.0), ("expm1", 710.0, INF), ("expm1", -1e300, -1.0)),
    *(
        ("log", INF, INF),
        ("log", 0.0, -INF),
        ("log", -0.0, -INF),
        ("log", -1.0, NAN),
        ("log", -INF, NAN),
    ),
    *(
        ("log", 1.0, 0.0),
        ("log1p", INF, INF),
        ("log1p", -1.0, -INF),
        ("log1p", -1.5, NAN),
        ("log1p", -INF, NAN),
    ),
    *(("sinh", INF, INF), ("sinh", -INF, -INF), ("sinh", 711.0, INF), ("sinh", 1e308, INF)),
    *(("cosh", INF, INF), ("cosh", -INF, INF), ("cosh", -711.0, INF)),
    *(("tanh", INF, 1.0), ("tanh", -INF, -1.0), ("atanh", 1.0, INF), ("atanh", -1.0, -INF)),
    *(
        (name, 5e-324, 5e-324)
        for name in ("sin", "tan", "asin", "atan", "expm1", "log1p", "sinh", "tanh", "atanh")
    ),
]

# y, x: the angle of (x, y).
DIRECTIONS = [
    *((zero, x, zero) for zero in (0.0, -0.0) for x in (0.0, 1.0, 5e-324, INF)),
    *(
        (zero, x, math.copysign(PI, zero))
        for zero in (0.0, -0.0)
        for x in (-0.0, -1.0, -5e-324, -INF)
    ),
    *((y, x, math.copysign(PI / 2, y)) for y in (1.0, -1.0, INF, -INF) for x in (0.0, -0.0)),
    *((y, x, math.copysign(PI / 2, y)) for y in (INF, -INF) for x in (1.0, -1e308)),
    *((y, INF, math.copysign(0.0, y)) for y in (1.0, -1.0)),
    *((y, -INF, math.copysign(PI, y)) for y in (1.0, -1.0)),
    *((y, INF, math.copysign(PI / 4, y)) for y in (INF, -INF)),
    *((y, -INF, math.copysign(3 * PI / 4, y)) for y in (INF, -INF)),
    *((y, x, math.copysign(PI / 4, y)) for y, x in ((2.0, 2.0), (5e-324, 5e-324), (-1e308, 1e308))),
    *((5e-324, 1e308, 0.0), (5e-324, -1e308, PI), (1e308, 5e-324, PI / 2)),
]

LENGTHS = [
    *(
        (0.0, -0.0, 0.0),
        (0.0, -3.0, 3.0),
        (3.0, -4.0, 5.0),
        (5e-324, 0.0, 5e-324),
        (1e200, 1e-200, 1e200),
    ),
    *((3e300, 4e300, 5e300), (3 * 2.0**-1073, 2.0**-1071, 5 * 2.0**-1073), (1.7e308, 1.7e308, INF)),
    *((INF, 1.0, INF), (NAN, INF, INF), (-INF, NAN, INF), (NAN, 1.0, NAN), (0.0, NAN, NAN)),
]


@pytest.mark.parametrize(("name", "x", "expected"), ONE_ARGUMENT)
def test_one_argument(name, x, expected):
    assert same(getattr(elementary, name)(x), expected)


@pytest.mark.parametrize(("y", "x", "expected"), DIRECTIONS)
def test_atan2(y, x, expected):
    assert same(elementary.atan2(y, x), expected)


@pytest.mark.parametrize(("x", "y", "expected"), LENGTHS)
def test_hypot(x, y, expected):
    assert same(elementary.hypot(x, y), expected)
    assert same(elementary.hypot(y, x), expected)


@pytest.mark.parametrize("name", ONE)
def test_nan_stays(name):
    assert math.isnan(getattr(elementary, name)(NAN))


@pytest.mark.parametrize("name", TWO)
def test_nan_in_one_of_two_stays(name):
    function = getattr(elementary, name)
    assert math.isnan(function(NAN, 1.0))
    assert math.isnan(function(1.0, NAN))


@pytest.mark.parametrize(
    ("x", "y"), [(INF, 1.0), (-INF, 2.0), (1.0, 0.0), (NAN, 1.0), (1.0, NAN), (INF, INF)]
)
def test_remainder_that_is_none(x, y):
    assert math.isnan(elementary.remainder(x, y))
    assert math.isnan(elementary.fmod(x, y))


def test_remainder_of_an_infinite_step_is_all():
    assert elementary.remainder(-3.0, INF) == -3.0
    assert elementary.fmod(-3.0, INF) == -3.0
