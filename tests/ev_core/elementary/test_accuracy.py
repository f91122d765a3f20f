"""No result is more than 1 ulp off, anywhere."""

from __future__ import annotations

import math

import numpy as np
import pytest
from elementary.precise import LIMITS, ONE, TWO, error, numbers, same
from hypothesis import given, settings
from hypothesis import strategies as st

from ev_core import elementary

pytestmark = pytest.mark.slow

PI = math.pi

# Where a function passes from one formula to the next, overflows or becomes subnormal, and where
# fdlibm's own formulas are known to be at their worst.
BORDERS = {
    "exp": (
        -745.1332191019411,
        -744.5,
        -708.5,
        -708.0,
        709.7,
        709.782712893384,
        0.010830424696223417,
        1e-300,
    ),
    "expm1": (
        0.3465735902799726,
        0.3465735902799727,
        -0.35,
        -0.7,
        0.69,
        0.7,
        -39.99,
        59.99,
        709.78,
        1e-17,
        1e-300,
    ),
    "log": (
        0.7071067811865475,
        0.7071067811865476,
        1.4142135623730951,
        5e-324,
        2.2e-308,
        0.9999999999999999,
        1.7e308,
    ),
    "log1p": (
        -0.29,
        -0.2899,
        0.41,
        0.4099,
        1.0,
        -0.9999999999999999,
        9007199254740993.0,
        1e-17,
        1e-300,
        1.7e308,
    ),
    "tanh": (0.55, 0.5499999999999999, 0.9730, 0.9732, 0.98, 22.0, 21.99, 1e-8, 1e-300),
    "sinh": (1.0, 0.9999999999999999, 22.0, 709.0, 709.9, 710.4758600739439, 1e-9, 1e-300),
    "cosh": (22.0, 21.99, 709.0, 709.9, 710.4758600739439, 7.56e-08),
    "atanh": (0.17, 0.1699, 0.5, 0.9999999999999999, 1e-9, 1e-300, 0.22370275327328126),
    "asin": (0.5, 0.49999999999999994, 0.975, 0.9749, 1.0, 0.5017, 1e-8, 1e-300),
    "acos": (0.5, 0.49999999999999994, -0.5, 1.0, -1.0, 0.9999999999999999, -0.5023700745275663),
    "atan": (0.4375, 0.6875, 1.1875, 2.4375, 0.7315, 1e17, 1e300, 1e-8, 1e-300),
}

# Multiples of pi/2 and the doubles that come closest to one: W. Kahan's 6381956970095103 * 2**797,
# J.-M. Muller's
# 5.3e255, and those of moderate size. 2**20 is where the way of reduction changes.
ANGLES = (
    *(n * PI / 2 for n in (*range(1, 30), 1000, 65535, 667543, 667544, 667545)),
    *(n * PI / 4 for n in range(1, 30, 2)),
    *(1048575.9999999999, 1048576.0, 1048577.0, 1e22, 5.5e22, 1e-8, 1e-300, 1.7976931348623157e308),
    *(
        6381956970095103.0 * 2.0**797,
        5.319372648326541e255,
        2.0**120,
        2.0**600,
        2.0**1023,
        411557987.0,
    ),
)


@pytest.mark.sampled
@pytest.mark.parametrize("name", ONE)
def test_error_of_one_argument_is_at_most_an_ulp(name):
    @given(numbers(name))
    @settings(max_examples=400)
    def holds(x):
        assert error(name, x) <= 1.0

    holds()


@pytest.mark.parametrize("name", ONE)
def test_error_near_one_is_at_most_an_ulp(name):
    """Even steps of a thousandth turn and more, which hypothesis seldom draws."""
    low, high = LIMITS.get(name, (None, None))
    generator = np.random.default_rng(7)
    for x in generator.uniform(max(-4.0, low or -4.0), min(4.0, high or 4.0), 1000).tolist():
        assert error(name, x) <= 1.0, x


@pytest.mark.parametrize("name", BORDERS)
def test_error_where_the_formula_changes(name):
    for x in BORDERS[name]:
        assert error(name, x) <= 1.0, x


@pytest.mark.parametrize("name", ["sin", "cos", "tan"])
def test_error_at_angles_that_are_hard_to_reduce(name):
    for x in ANGLES:
        for angle in (x, math.nextafter(x, 0.0), -x):
            assert error(name, angle) <= 1.0, angle


@pytest.mark.parametrize("name", TWO)
def test_error_of_two_arguments_is_at_most_an_ulp(name):
    """Independent numbers seldom are of one size, so pairs of a bounded ratio, too, at all sizes.

    Without y = 0: arbitrary precision knows no sign of zero.
    """
    any_size = st.floats(allow_nan=False, allow_infinity=False).filter(bool)

    @given(any_size, any_size, st.floats(-4.0, 4.0), st.floats(0.1, 4.0), st.integers(-1068, 1021))
    @settings(max_examples=500)
    def holds(x, y, near_x, near_y, exponent):
        assert error(name, y, x) <= 1.0
        assert error(name, math.ldexp(near_y, exponent), math.ldexp(near_x, exponent)) <= 1.0

    holds()


@pytest.mark.parametrize("name", TWO)
def test_error_of_sides_of_one_size(name):
    generator = np.random.default_rng(8)
    for y, x in generator.uniform(-1.0, 1.0, (2000, 2)).tolist():
        assert error(name, y, x) <= 1.0, (y, x)


def test_remainders_are_those_of_python():
    """Remainders are exact, also at halves, where the even multiple is taken."""
    finite = st.floats(allow_nan=False, allow_infinity=False)

    @given(finite, st.one_of(finite, st.sampled_from([2 * PI, PI, 1.0, 0.5, 0.3])).filter(bool))
    @settings(max_examples=600)
    def holds(x, y):
        for value in (x, 1.5 * y, -2.5 * y, x % y):
            if math.isfinite(value):
                assert same(elementary.remainder(value, y), math.remainder(value, y))
                assert same(elementary.fmod(value, y), math.fmod(value, y))

    holds()
