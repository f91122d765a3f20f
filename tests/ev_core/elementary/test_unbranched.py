"""The functions without branches.

As exact as they say within their ranges, and with the same bits compiled.
"""

from __future__ import annotations

import mpmath
import numpy as np
import pytest
from elementary.precise import compiled

from ev_core.elementary import unbranched

GENERATOR = np.random.default_rng(11)
ANGLES = GENERATOR.uniform(-1.5707963267948966, 1.5707963267948966, 1000)
QUOTIENTS = np.concatenate(
    [10.0 ** GENERATOR.uniform(-8.0, 6.0, 500), GENERATOR.uniform(0.0, 3.0, 500)]
)
EXPONENTS = GENERATOR.uniform(-4.0, 4.0, 1000)


def angle_of(x: float) -> float:
    return unbranched.first_quadrant(0.7 * x, 0.7)


@pytest.mark.parametrize(
    ("ours", "exact", "arguments", "error"),
    [
        (angle_of, mpmath.atan, QUOTIENTS, 1.5e-15),
        (unbranched.rising_sine, mpmath.sin, ANGLES, 6e-16),
        (unbranched.moderate_exp, mpmath.exp, EXPONENTS, 7e-15),
    ],
    ids=["angle", "sine", "exp"],
)
def test_relative_error(ours, exact, arguments, error):
    """Against arbitrary precision (measured over 40 000 arguments: 1.2e-15, 5.6e-16, 6.1e-15)."""
    for x in arguments.tolist():
        assert abs(ours(x) / exact(mpmath.mpf(x)) - 1.0) <= error, x


def multiples(x: float) -> float:
    sine, cosine = (
        unbranched.sine_of_multiple(2.9, x, 0.4),
        unbranched.cosine_of_multiple(3.9, x, 0.4),
    )
    return (sine - 2.0 * cosine) * unbranched.moderate_exp(0.001 * x)


@pytest.mark.slow
def test_python_and_compiled_have_the_same_bits():
    """All functions at once, four numbers at a time: the compiler widens the loop over an array."""
    x = GENERATOR.uniform(0.0, 30.0, 20_001)
    out = np.empty_like(x)
    compiled(multiples, 1)(x, out)
    assert (out == np.array([multiples(value) for value in x.tolist()])).all()


def test_multiples_of_an_angle_keep_to_their_sector():
    """Up to 3 and 4 quarter turns, where the angle folds back (absolute error measured 1.6e-15)."""
    for x in QUOTIENTS.tolist()[::10]:
        angle = mpmath.atan(mpmath.mpf(x))
        assert abs(unbranched.sine_of_multiple(3.0, x, 1.0) - mpmath.sin(3.0 * angle)) <= 2e-15
        assert abs(unbranched.cosine_of_multiple(4.0, x, 1.0) - mpmath.cos(4.0 * angle)) <= 2e-15
