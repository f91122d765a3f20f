"""When the friction in use is that of the road, and what is believed of the road else."""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.shared.wheel_dynamics import slowest_wheel
from ev_msgs_py.compiling.compilable import compilable
from ev_msgs_py.parameters.declaration import parameter


@dataclass(frozen=True, slots=True)
class FrictionLearningParameters:
    """How the friction under a wheel is learnt while it slips; the source takes it as known."""

    largest_friction: float = parameter(
        1.2, unit="1", low=0.01, high=3.0, about="friction at the start and at most", source="assumption"
    )
    learning_slip: float = parameter(
        0.15,
        unit="1",
        low=0.01,
        high=1.0,
        about="slip from which on the friction in use is taken for the friction of the road",
        source="assumption",
    )
    filter_time: float = parameter(
        0.02, unit="s", low=0.0, high=1.0, about="time constant of the friction in use", source="assumption"
    )
    rise: float = parameter(
        0.3,
        unit="1/s",
        low=0.0,
        high=100.0,
        about="rise of the estimate without slip, which finds out when the road gets better",
        source="assumption",
    )
    slowest: float = slowest_wheel()


@compilable
def learnt_friction(p: FrictionLearningParameters, friction: float, used: float, slip: float, period: float) -> float:
    """The friction to believe in after a period [s], by the one before, the filtered one in use and the slip [1].

    A wheel that slips shows the friction of the road; of one that grips only a value that slowly rises is known:
    a saw tooth, which finds a better road only after a while, and a worse one by slipping.
    """
    if slip > p.learning_slip:
        return min(max(used, 0.0), p.largest_friction)
    return min(friction + p.rise * period, p.largest_friction)
