"""Gains of method 1 (dissertation, eqs 3.1, 5.1 and 5.2) from the printed tables."""

from __future__ import annotations

import pytest

from ev_papers.dissertation.studies import five_methods as printed
from ev_papers.dissertation.studies.five_methods import gains, savings


def test_gains_by_hand():
    """0.8 against 0.6: a quarter of 0.8, a third of 0.6."""
    found = gains({1: 0.8, 2: 0.6})
    assert found.over_method_1 == {2: pytest.approx(25.0)}
    assert found.over_the_other == {2: pytest.approx(100.0 / 3.0)}


def test_the_range_of_eq_5_1_comes_from_the_other_denominator():
    """Printed: 2.8 to 15.3 %.

    Over eta_i, as eq 5.1 is printed, the largest gain would be 18.1 %.
    """
    found = gains(printed.DRIVE_EFFICIENCY)
    assert (min(found.over_method_1.values()), max(found.over_method_1.values())) == pytest.approx(
        (2.8, 15.3), abs=0.1
    )
    assert max(found.over_the_other.values()) == pytest.approx(18.1, abs=0.1)


def test_savings_of_table_5_6():
    """1.9 to 10.5 kWh are printed."""
    found = savings(printed.ENERGY)
    assert (min(found.values()), max(found.values())) == pytest.approx((1.9, 10.5), abs=0.05)
