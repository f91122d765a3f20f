"""Control with limits: the integral part stays in reach."""

from __future__ import annotations

from hypothesis import given
from hypothesis import strategies as st

from ev_sim.driver.pedals import limited_pid

PERIOD = 0.01


@given(
    errors=st.lists(st.floats(-1000.0, 1000.0), max_size=50),
    low=st.floats(-50.0, 0.0),
    high=st.floats(0.0, 50.0),
)
def test_output_keeps_its_limits_and_the_integral_stays_in_reach(errors, low, high):
    """The integral grows only inside the limits: one period's growth is all beyond them.

    Proportional action of the other sign lets it go further, by as much as it takes away.
    """
    integral = 0.0
    reach = max(map(abs, errors), default=0.0) * (1.0 + 2.0 * PERIOD)
    for error in errors:
        output, integral = limited_pid(error, 2.0 * PERIOD * error, integral, low, high)
        assert low <= output <= high
        assert low - reach - 1e-9 <= integral <= high + reach + 1e-9


def test_integral_holds_at_the_limit_and_comes_back_from_it():
    """10 + 5 is limited to 12 and the growth of 1 refused.

    A growth of -1 is taken, though the output is limited.
    """
    assert limited_pid(10.0, 1.0, 5.0, -12.0, 12.0) == (12.0, 5.0)
    assert limited_pid(10.0, -1.0, 5.0, -12.0, 12.0) == (12.0, 4.0)
    assert limited_pid(-10.0, -1.0, -5.0, -12.0, 12.0) == (-12.0, -5.0)
    assert limited_pid(-10.0, 1.0, -5.0, -12.0, 12.0) == (-12.0, -4.0)
    assert limited_pid(6.0, 1.0, 2.0, -12.0, 12.0) == (9.0, 3.0)
