"""Mirrored arguments give mirrored numbers to the last bit; functions that rise, rise."""

from __future__ import annotations

import math

import numpy as np
import pytest
from elementary.precise import EVEN, LIMITS, ODD, numbers, same
from hypothesis import given, settings
from hypothesis import strategies as st

from ev_core import elementary

FINITE = st.floats(allow_nan=False, allow_infinity=False)


@pytest.mark.parametrize("name", ODD)
def test_odd(name):
    function = getattr(elementary, name)

    @given(numbers(name))
    def holds(x):
        assert same(function(-x), -function(x))

    holds()


@pytest.mark.parametrize("name", EVEN)
def test_even(name):
    function = getattr(elementary, name)

    @given(numbers(name))
    def holds(x):
        assert same(function(-x), function(x))

    holds()


@given(st.one_of(st.floats(-30.0, 30.0), FINITE))
@settings(max_examples=500)
def test_sin_cos_are_sin_and_cos(x):
    sine, cosine = elementary.sin_cos(x)
    assert same(sine, elementary.sin(x))
    assert same(cosine, elementary.cos(x))


@given(FINITE, FINITE)
def test_direction_turns_with_the_sign_of_y(y, x):
    assert same(elementary.atan2(-y, x), -elementary.atan2(y, x))


@given(FINITE, FINITE)
def test_length_knows_no_order_and_no_sign(x, y):
    length = elementary.hypot(x, y)
    assert same(elementary.hypot(y, x), length)
    assert same(elementary.hypot(-x, y), length)
    assert same(elementary.hypot(x, -y), length)


RISING = ("asin", "atan", "exp", "expm1", "log", "log1p", "sinh", "tanh", "atanh", "sin", "tan")


@pytest.mark.parametrize("name", RISING)
def test_rises_with_its_argument(name):
    """Distances of more than 1 ulp are needed: the bound of the error does not ensure it."""
    low, high = LIMITS.get(name, (None, None))
    limit = math.pi / 2 if name in ("sin", "tan") else 4.0
    function = getattr(elementary, name)
    generator = np.random.default_rng(3)
    for x in generator.uniform(
        max(-limit, low or -limit), min(limit, high or limit), 2000
    ).tolist():
        assert function(x) <= function(x + 4.0 * math.ulp(x)), x


@given(st.floats(-1e6, 1e6))
def test_squares_of_sine_and_cosine_add_up_to_one(x):
    sine, cosine = elementary.sin_cos(x)
    # 1 ulp of each of three roundings
    assert sine * sine + cosine * cosine == pytest.approx(1.0, abs=4.5e-16)


@given(st.floats(1e-100, 1e100), st.floats(-math.pi, math.pi))
def test_polar_coordinates_there_and_back(length, angle):
    """Five ulp of 1 for the roundings of sine, cosine, both products and the way back."""
    sine, cosine = elementary.sin_cos(angle)
    assert elementary.hypot(length * cosine, length * sine) == pytest.approx(length, rel=1.1e-15)
    assert elementary.atan2(length * sine, length * cosine) == pytest.approx(
        angle, rel=1.1e-15, abs=1e-200
    )
