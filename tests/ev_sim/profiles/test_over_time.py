"""Profiles and windows at many times at once are those one by one."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ev_sim.profiles.cycle_windows import (
    MODES,
    CycleModesParameters,
    cycle_modes,
    mode_at,
    modes_at,
    values_at,
)
from ev_sim.profiles.profile import INTERPOLATIONS, profile_of, value_at

points = st.dictionaries(
    st.integers(-200, 200).map(lambda n: n / 4), st.floats(-40.0, 40.0), min_size=1, max_size=6
).map(lambda found: tuple(zip(*sorted(found.items()), strict=True)))
times = st.lists(st.floats(-60.0, 60.0), max_size=20)


@pytest.mark.parametrize("interpolation", INTERPOLATIONS)
@given(points=points, times=times)
def test_values_are_those_one_by_one(interpolation, points, times):
    """Between, at (the points themselves are among the times), before and behind the points.

    Equal to the bit.
    """
    profile = profile_of(*points, interpolation)
    times = [*times, *profile.time]
    assert values_at(profile, np.array(times)).tolist() == [value_at(profile, t) for t in times]


@given(
    points=points,
    times=times,
    mode=st.lists(st.sampled_from(MODES), min_size=6, max_size=6),
    windows=st.booleans(),
)
def test_modes_are_those_one_by_one(points, times, mode, windows):
    """Both agree with windows, which begin at the points here, and without."""
    cycle = profile_of(*points, "linear")
    begin = tuple(t + 50.0 for t in cycle.time) if windows else ()
    modes = cycle_modes(CycleModesParameters(begin, tuple(mode[: len(begin)])), cycle)
    times = [*times, *begin, *cycle.time]
    assert modes_at(modes, np.array(times)).tolist() == [mode_at(modes, t) for t in times]
