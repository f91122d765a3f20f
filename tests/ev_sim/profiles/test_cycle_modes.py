"""Windows of a cycle, and the mode of the driver in each."""

from __future__ import annotations

import pytest

from ev_core.parameters.data_file import find_file
from ev_msgs_py.refusal import ParameterError
from ev_sim.profiles.cycle_windows import (
    MODES,
    REGENERATION,
    STOP,
    TRACTION,
    CycleModesParameters,
    WindowRuleParameters,
    cycle_modes,
    mode_at,
    windows_by_rule,
)
from ev_sim.profiles.profile import (
    SpeedProfileParameters,
    profile_of,
    wanted_speed,
    with_profile_from_file,
)
from ev_stack.scenarios.scenario import load_scenario

# Stands, drives, keeps its speed, slows down, stands.
CYCLE = profile_of((0.0, 1.0, 2.0, 3.0, 4.0), (0.0, 0.0, 5.0, 5.0, 0.0), "linear")
RULE = WindowRuleParameters()


@pytest.mark.parametrize(
    ("time", "mode"),
    [
        (0.0, STOP),
        (0.75, STOP),
        (1.0, TRACTION),
        (2.75, TRACTION),
        (3.0, REGENERATION),
        (3.75, REGENERATION),
        (4.0, STOP),
        (9.0, STOP),
    ],
)
def test_without_windows_a_rule_says_the_mode(time, mode):
    """A falling profile is regen, one that stays at zero is stop, the rest is traction."""
    assert mode_at(cycle_modes(CycleModesParameters(), CYCLE), time) == mode


@pytest.mark.parametrize(
    ("time", "mode"), [(0.0, STOP), (0.5, TRACTION), (1.9, TRACTION), (2.0, REGENERATION)]
)
def test_windows_say_the_mode_whatever_the_cycle(time, mode):
    """Each from its beginning on until the next.

    Before the first the car stands, the last one holds.
    """
    windows = CycleModesParameters(begin=(0.5, 2.0), mode=(MODES[TRACTION], MODES[REGENERATION]))
    assert mode_at(cycle_modes(windows, CYCLE), time) == mode


def test_rule_finds_the_windows_that_the_dissertation_lists():
    """All 19, but that the source drives from 49.7 to 57.3 s while the speed falls."""
    listed = load_scenario("urban_mixed").runs[0].configurations["driver"].parameters
    begin, mode = windows_by_rule(RULE, wanted_speed(listed.speed_profile))
    found = list(zip(begin, (MODES[place] for place in mode), strict=True))
    slowing_down = [(49.7, "regen"), (57.3, "traction")]
    assert [window for window in found if window not in slowing_down] == list(
        zip(listed.modes.begin, listed.modes.mode, strict=True)
    )
    assert len(found) == 21


@pytest.mark.parametrize(
    "name", sorted(path.stem for path in find_file("cycles/ece_15.csv").parent.glob("*.csv"))
)
def test_windows_of_all_cycles_are_whole(name):
    """No window between two of one mode is shorter than the rule allows.

    The car stands at both ends.
    """
    cycle = wanted_speed(with_profile_from_file(SpeedProfileParameters(file=f"cycles/{name}.csv")))
    begin, mode = windows_by_rule(RULE, cycle)
    assert mode[0] == mode[-1] == STOP
    for n in range(1, len(mode) - 1):
        assert mode[n] != mode[n - 1]
        if mode[n - 1] == mode[n + 1] != STOP != mode[n]:
            assert begin[n + 1] - begin[n] > RULE.shortest


def test_hold_between_two_falls_is_no_traction_and_a_step_does_not_fall():
    """5 s held at 4 m/s belong to the fall, 5.5 s do not, nor does a rise.

    In steps nothing falls but at once.
    """
    for length, modes in (
        (5.0, (REGENERATION, STOP)),
        (5.5, (REGENERATION, TRACTION, REGENERATION, STOP)),
    ):
        times = (0.0, 5.0, 5.0 + length, 10.0 + length)
        assert windows_by_rule(RULE, profile_of(times, (8.0, 4.0, 4.0, 0.0), "linear"))[1] == modes
        assert (
            windows_by_rule(RULE, profile_of(times, (8.0, 4.0, 5.0, 0.0), "linear"))[1][1]
            == TRACTION
        )
    assert windows_by_rule(RULE, profile_of((0.0, 5.0), (8.0, 0.0), "step")) == (
        (0.0, 5.0),
        (TRACTION, STOP),
    )


def test_bad_windows_are_refused():
    with pytest.raises(
        ParameterError, match="begin and mode have 1 and 0 elements, expected the same number"
    ):
        CycleModesParameters(begin=(0.0,))
    with pytest.raises(
        ParameterError, match="begin: 1 s after 1 s is refused, expected increasing time"
    ):
        CycleModesParameters(begin=(1.0, 1.0), mode=("stop", "regen"))
