"""What a driver does in each window of a speed cycle: stand, drive, or slow down by the drives."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.parameters.declaration import ParameterError, group, parameter
from ev_sim.profiles.profile import Profile, number_until
from ev_sim.profiles.windows_by_rule import MODES, STOP, WindowRuleParameters, windows_by_rule


@dataclass(frozen=True, slots=True)
class CycleModesParameters:
    """The windows of a cycle; without any they follow from the profile by a rule."""

    begin: tuple[float, ...] = parameter(
        (),
        unit="s",
        low=0.0,
        high=1e5,
        about="times at which the windows begin, increasing; empty: found by the rule",
        source="dissertation, section 2.6",
    )
    mode: tuple[str, ...] = parameter((), choices=MODES, about="what each window is for; the last one holds")
    rule: WindowRuleParameters = group(WindowRuleParameters)

    def __post_init__(self) -> None:
        if len(self.begin) != len(self.mode):
            raise ParameterError(
                f"begin and mode have {len(self.begin)} and {len(self.mode)} elements, allowed is the same number"
            )
        for earlier, later in pairwise(self.begin):
            if not earlier < later:
                raise ParameterError(f"begin: {later:g} s after {earlier:g} s is refused, allowed is increasing time")


class CycleModes(NamedTuple):
    """Times at which the windows of a cycle begin [s], and the place of each window's mode in MODES."""

    begin: tuple[float, ...]
    mode: tuple[float, ...]


def cycle_modes(parameters: CycleModesParameters, cycle: Profile) -> CycleModes:
    """The windows that the parameters name, or those that the rule finds."""
    if parameters.begin:
        return CycleModes(parameters.begin, tuple(float(MODES.index(name)) for name in parameters.mode))
    begin, mode = windows_by_rule(parameters.rule, cycle)
    return CycleModes(begin, tuple(map(float, mode)))


@compilable
def mode_at(modes: CycleModes, t: float) -> int:
    """The mode at the time t [s]; before the first window the car stands."""
    begun = number_until(modes.begin, t)
    return int(modes.mode[begun - 1]) if begun > 0 else STOP
