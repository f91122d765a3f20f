"""A torque command fades with its age.

Nothing of it acts behind the instant that is promised, to the nanosecond.
"""

import time
from fractions import Fraction

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from ev_msgs_py.contract.signals import WheelTorqueCommand
from ev_msgs_py.contract.stamps import NANOSECONDS, from_seconds
from ev_nodes.master.real_time import FadingInputs, MasterParameters


def share_at(age: int, wall_age: float, period: int, p: MasterParameters) -> float:
    """Share left of a command [1] that is stamped 1 s and has these ages [ns], [s]."""
    held = FadingInputs((WheelTorqueCommand,))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(time, "monotonic", lambda: 100.0)
        numbers = [50.0, 50.0, *[0.0] * 6]
        assert held.take(WheelTorqueCommand, NANOSECONDS, numbers, NANOSECONDS)
        patch.setattr(time, "monotonic", lambda: 100.0 + wall_age)
        return held.share(NANOSECONDS + age, period, p)


@given(
    st.integers(1, 100_000).map(lambda us: us * 1000),
    st.integers(0, 200),
    st.integers(2, 200),
    st.sampled_from((0.0, 0.005, 0.02)),
)
@example(10_000_000, 9, 10, 0.02)  # 0.1 s - 0.09 s - 0.01 s is 8.7e-18 s in floats
@example(10_000_000, 9, 10, 0.0)
def test_nothing_acts_in_a_step_that_ends_when_the_command_is_too_old(period, steps, allowed, ramp):
    """The share is the time left over the ramp, counted in whole nanoseconds.

    Without a ramp it is all or nothing.
    """
    p = MasterParameters(command_timeout=allowed * period / NANOSECONDS, command_ramp=ramp)
    left = (allowed - steps - 1) * period
    share = share_at(steps * period, 0.0, period, p)
    if left <= 0:
        assert share == 0.0
    elif ramp == 0.0:
        assert share == 1.0
    else:  # a division and a rounding of what is exact here
        assert share == pytest.approx(float(min(Fraction(left, from_seconds(ramp)), 1)), rel=1e-15)


def test_the_older_of_both_clocks_counts():
    p = MasterParameters(command_timeout=0.1, command_ramp=0.02)
    period = 10_000_000
    # 5 of 20 ms; the wall clock is in floats
    assert share_at(0, 0.085, period, p) == pytest.approx(0.25, rel=1e-6)
    assert share_at(75_000_000, 0.0, period, p) == 0.75
    assert share_at(0, 0.1, period, p) == 0.0
