"""What traction controls that regulate a slip share: when they begin, and when they end."""

from __future__ import annotations

import math
from abc import abstractmethod
from dataclasses import dataclass, field
from typing import Any

from ev_control.asr.slip_observers import SlipObserver, SlipObserverParameters, SlipObserverState
from ev_control.asr.traction_control import LimitedWheel, TractionControl, WheelMotion
from ev_control.reference_speed import ReferenceSpeedParameters
from ev_msgs_py.parameters import group, parameter
from ev_msgs_py.vehicle import Vehicle


@dataclass(frozen=True, slots=True)
class SlipRegulatorParameters:
    """The slip that is wanted, and what is measured of it; the source gives no number."""

    target: float = parameter(
        0.1,
        unit="1",
        low=0.01,
        high=0.5,
        about="wanted slip; the peaks of snow and wet asphalt lie at 0.09 and 0.13",
        source="assumption",
    )
    release: float = parameter(
        0.2,
        unit="s",
        low=0.0,
        high=100.0,
        about="time for which the limit has to be above the request before it ends",
        source="assumption",
    )
    slip: SlipObserverParameters = group(SlipObserverParameters)
    reference: ReferenceSpeedParameters = group(ReferenceSpeedParameters)


@dataclass(slots=True)
class RegulatedWheel(LimitedWheel):
    """Observed slip, and since when the limit is above the request [s]."""

    observer: SlipObserverState = field(default_factory=SlipObserverState)
    served: float = 0.0


class SlipRegulator(TractionControl):
    """No limit until the slip exceeds its target; then that of `_regulated`, until the request stays below it."""

    def __init__(
        self, law: str, wheel: type, regulator: SlipRegulatorParameters, vehicle: Vehicle, period: float
    ) -> None:
        self._regulator = regulator
        self._observer = SlipObserver(regulator.slip, vehicle, period)
        super().__init__(law, wheel, regulator.reference, vehicle, period)

    def _limit(self, wheel: Any, motion: WheelMotion, wanted: float) -> float:
        slip = self._observer.slip(wheel.observer, motion)
        begins = wheel.limit == math.inf
        self._watch(wheel, motion)
        if begins and slip <= self._regulator.target:
            return math.inf
        limit = self._regulated(wheel, motion, slip, wanted, begins)
        wheel.served = wheel.served + self._period if limit >= wanted else 0.0
        if wheel.served <= self._regulator.release:
            return limit
        wheel.served = 0.0
        return math.inf

    def _watch(self, wheel: Any, motion: WheelMotion) -> None:
        """Go on with what has to be known before the slip is too large."""

    @abstractmethod
    def _regulated(self, wheel: Any, motion: WheelMotion, slip: float, wanted: float, begins: bool) -> float:
        """The torque [N m] that brings this slip [1] to the target; `begins` in the first step of an intervention."""
