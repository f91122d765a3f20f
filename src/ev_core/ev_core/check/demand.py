"""What a law makes of the driver: its torques have to depend on the drive and on the brake that it is asked for.

A law that drops one of them is no torque vectoring: on a benchmark it would save the energy of what it does not do.
"""

import numpy as np

from ev_core.check.stepping import Subject, outputs
from ev_msgs_py.contract import frame
from ev_msgs_py.contract.fields import shape_of
from ev_msgs_py.contract.signals import DriverCommand, WheelTorqueRequest

_ASKS = {"electronic_differential": DriverCommand, "asr": WheelTorqueRequest}  # by role what it is asked by
_PEDALS = ("drive", "brake")
_TORQUE = 300.0  # N m, of all wheels or of each


def ignored_demand(subject: Subject, seed: int) -> str:
    """Which pedal changes nothing of a run, with the other one free; empty if both do, or if the role has none."""
    asks = _ASKS.get(subject.configuration.role)
    if asks is None:
        return ""
    places = {pedal: _places(asks, pedal) for pedal in _PEDALS}
    free = subject.frames(seed).copy()
    free[:, [place for of in places.values() for place in of]] = 0.0
    for pedal, of in places.items():
        pressed = free.copy()
        pressed[:, of] = _TORQUE
        if np.array_equal(outputs(subject.part(), pressed), outputs(subject.part(), free)):
            return f"{asks.__name__}.{pedal} has no effect: the same torques with {_TORQUE:.0f} N m as without"
    return ""


def _places(kind: type, pedal: str) -> list[int]:
    """Those of a pedal in a frame."""
    channels = zip(shape_of(kind).channels, frame.places(kind), strict=True)
    return [place for channel, place in channels if channel.startswith(pedal)]
