"""Sums that keep their rounding errors and add them up as well."""

from __future__ import annotations

import math
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ev_control.estimation.slip_curve_fit import EMPTY_SUM, plus, rounded


def total_of(numbers: list[float]) -> float:
    total = EMPTY_SUM
    for number in numbers:
        total = plus(total, number)
    return rounded(total)


@given(numbers=st.lists(st.floats(0.0, 1.0), max_size=60))
def test_sum_of_slips_is_off_by_half_a_bit_at_most(numbers):
    """The lost part is a sum of at most 60 numbers below 1e-14.

    Its own rounding is some 1e-28, a 1e-12th of a bit.
    """
    exact = sum(map(Fraction, numbers))
    assert abs(Fraction(total_of(numbers)) - exact) <= Fraction(math.ulp(float(exact))) * Fraction(
        0.5 + 1e-9
    )


def test_what_a_plain_sum_loses_is_kept():
    """A thousand terms of half a bit of 1 or less.

    Added to it one by one, nothing is left of them.
    """
    numbers = [1.0, *[1e-16] * 1000, -1.0]
    assert sum(numbers) == 0.0
    assert total_of(numbers) == pytest.approx(1e-13, rel=1e-12)
