"""What a driver does in each window of a cycle."""

from __future__ import annotations

import pytest

from ev_msgs_py.parameters.declaration import ParameterError
from ev_sim.profiles.cycle_modes import MODES, REGENERATION, STOP, TRACTION, CycleModesParameters, cycle_modes, mode_at
from ev_sim.profiles.profile import profile_of

# Stands, drives, keeps its speed, slows down, stands.
CYCLE = profile_of((0.0, 1.0, 2.0, 3.0, 4.0), (0.0, 0.0, 5.0, 5.0, 0.0), "linear")
PERIOD = 0.25


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
def test_without_windows_the_next_period_of_the_cycle_says_the_mode(time, mode):
    """A falling profile is regen, one that stays at zero is stop, the rest is traction."""
    assert mode_at(cycle_modes(CycleModesParameters()), CYCLE, time, PERIOD) == mode


@pytest.mark.parametrize(("time", "mode"), [(0.0, STOP), (0.5, TRACTION), (1.9, TRACTION), (2.0, REGENERATION)])
def test_windows_say_the_mode_whatever_the_cycle(time, mode):
    """Each from its beginning on until the next; before the first the car stands, the last one holds."""
    windows = CycleModesParameters(begin=(0.5, 2.0), mode=(MODES[TRACTION], MODES[REGENERATION]))
    assert mode_at(cycle_modes(windows), CYCLE, time, PERIOD) == mode


def test_bad_windows_are_refused():
    with pytest.raises(ParameterError, match="begin and mode have 1 and 0 elements, allowed is the same number"):
        CycleModesParameters(begin=(0.0,))
    with pytest.raises(ParameterError, match="begin: 1 s after 1 s is refused, allowed is increasing time"):
        CycleModesParameters(begin=(1.0, 1.0), mode=("stop", "regen"))
