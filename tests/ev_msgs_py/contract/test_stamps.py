"""Time is whole nanoseconds, and seconds are only shown."""

from hypothesis import given
from hypothesis import strategies as st

from ev_msgs_py.contract.stamps import from_seconds, to_seconds

PERIODS = st.sampled_from((0.0001, 0.001, 0.005, 0.01, 1 / 30, 1.0))


@given(PERIODS, st.floats(0.0, 4e6))
def test_seconds_lead_back_to_the_stamp_for_weeks(period, time):
    """Seconds as a float still tell nanoseconds apart at 4e6 s, where their spacing is 0.47 ns."""
    stamp = int(time / period) * from_seconds(period)
    assert from_seconds(to_seconds(stamp)) == stamp
