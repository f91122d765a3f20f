"""What a driver does in each window of a speed cycle: stand, drive, or slow down by the drives."""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass
from itertools import pairwise

from ev_msgs_py.parameters import ParameterError, parameter
from ev_sim.driver.profile import Profile

MODES = STOP, TRACTION, REGENERATION = "stop", "traction", "regen"


@dataclass(frozen=True, slots=True)
class CycleModesParameters:
    """The windows of a cycle; without any they follow from the profile."""

    begin: tuple[float, ...] = parameter(
        (),
        unit="s",
        low=0.0,
        high=1e5,
        about="times at which the windows begin, increasing; empty: a falling profile is regen, one that stays at "
        "zero is stop, the rest is traction",
        source="dissertation, section 2.6",
    )
    mode: tuple[str, ...] = parameter((), choices=MODES, about="what each window is for; the last one holds")

    def __post_init__(self) -> None:
        if len(self.begin) != len(self.mode):
            raise ParameterError(
                f"begin and mode have {len(self.begin)} and {len(self.mode)} elements, allowed is the same number"
            )
        for earlier, later in pairwise(self.begin):
            if not earlier < later:
                raise ParameterError(f"begin: {later:g} s after {earlier:g} s is refused, allowed is increasing time")


class CycleModes:
    """The mode at a time, from windows or from the slope of the profile over the next `period` [s]."""

    def __init__(self, parameters: CycleModesParameters, profile: Profile, period: float) -> None:
        self._begin, self._mode = parameters.begin, parameters.mode
        self._profile, self._period = profile, period

    def at(self, t: float) -> str:
        """One of MODES at the time t [s]; before the first window the car stands."""
        if self._begin:
            n = bisect_right(self._begin, t)
            return self._mode[n - 1] if n else STOP
        now, next_ = self._profile.at(t), self._profile.at(t + self._period)
        if next_ < now:
            return REGENERATION
        return TRACTION if next_ > 0.0 else STOP
