"""Values over time: interpolation, and what is refused."""

from __future__ import annotations

from bisect import bisect_right

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ev_core.parameters.values import build
from ev_msgs_py.refusal import ParameterError
from ev_sim.driver.followers import SpeedProfileDriverParameters
from ev_sim.profiles.profile import number_until, profile_of, value_at


@pytest.mark.parametrize(
    ("time", "linear", "step"),
    [
        (-1.0, 2.0, 2.0),
        (0.0, 2.0, 2.0),
        (1.0, 3.0, 2.0),
        (2.0, 4.0, 4.0),
        (3.5, -2.0, 4.0),
        (4.0, -4.0, -4.0),
        (9.0, -4.0, -4.0),
    ],
)
def test_profiles_go_from_point_to_point_and_hold_their_ends(time, linear, step):
    points = (0.0, 2.0, 4.0), (2.0, 4.0, -4.0)
    assert value_at(profile_of(*points, "linear"), time) == linear
    assert value_at(profile_of(*points, "step"), time) == step


times = st.integers(-20, 20).map(lambda n: n / 4)


@given(points=st.sets(times, max_size=12).map(sorted), t=times)
def test_number_of_points_until_a_time_is_that_of_bisect(points, t):
    assert number_until(tuple(points), t) == bisect_right(points, t)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        (
            {"speed_profile.time": (0.0, 1.0)},
            "speed_profile.time and speed have 2 and 4 elements, expected the same",
        ),
        (
            {"speed_profile.time": (), "speed_profile.speed": ()},
            "have 0 and 0 elements, expected .* at least one",
        ),
        (
            {
                "steering.hand_torque.time": (0.0, 2.0, 1.0),
                "steering.hand_torque.torque": (0.0, 1.0, 2.0),
            },
            "steering.hand_torque.time: 1 s after 2 s is refused, expected increasing time",
        ),
        (
            {"steering.wanted_angle.time": (3.0, 3.0), "steering.wanted_angle.angle": (0.0, 1.0)},
            "steering.wanted_angle.time: 3 s after 3 s is refused, expected increasing time",
        ),
        (
            {"steering.mode": "feet"},
            "steering.mode: 'feet' is refused, expected one of hand_torque, angle",
        ),
    ],
)
def test_bad_profiles_are_refused_in_one_line(values, message):
    with pytest.raises(ParameterError, match=message) as error:
        build(SpeedProfileDriverParameters, values)
    assert "\n" not in str(error.value)
