"""When the friction in use is that of the road; `estimation.friction_learning` as a method of its parameters."""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.estimation.friction_learning import FrictionLearningParameters as _Parameters
from ev_control.estimation.friction_learning import learnt_friction


@dataclass(frozen=True, slots=True)
class FrictionLearningParameters(_Parameters):
    """How the friction under a wheel is learnt while it slips; the source takes it as known."""

    def learnt(self, friction: float, used: float, slip: float, period: float) -> float:
        """See `learnt_friction`."""
        return learnt_friction(self, friction, used, slip, period)
