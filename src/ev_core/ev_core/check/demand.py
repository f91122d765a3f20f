"""Check that a law obeys the driver.

Its torques depend on the drive and on the brake that it is asked for. A law that drops one of them
is no torque vectoring: on a benchmark it would save the energy of the torque that it does not give.
"""

import numpy as np

from ev_core.check.stepping import Subject, outputs
from ev_msgs_py.contract import frame
from ev_msgs_py.contract.fields import shape_of
from ev_msgs_py.contract.signals import DriverCommand, WheelTorqueRequest

# By role the signal with its demand.
_ASKS = {"electronic_differential": DriverCommand, "asr": WheelTorqueRequest}
_PEDALS = ("drive", "brake")
_TORQUE = 300.0  # N m, of all wheels or of each


def ignored_demand(subject: Subject, seed: int) -> str:
    """Name a pedal that changes no torque with the other one free.

    Empty if both do, or if the role has none.
    """
    asks = _ASKS.get(subject.configuration.role)
    if asks is None:
        return ""
    free = subject.frames(seed).copy()
    for pedal in _PEDALS:
        free[:, _places(asks, pedal)] = 0.0
    unpressed = outputs(subject.part(), free)
    for pedal in _PEDALS:
        pressed = free.copy()
        pressed[:, _places(asks, pedal)] = _TORQUE
        if np.array_equal(outputs(subject.part(), pressed), unpressed):
            alike = f"the same torques with {_TORQUE:.0f} N m as without"
            return f"{asks.__name__}.{pedal} has no effect: {alike}"
    return ""


def _places(kind: type, pedal: str) -> list[int]:
    """Places of a pedal's numbers in a frame."""
    channels = zip(shape_of(kind).channels, frame.places(kind), strict=True)
    return [place for channel, place in channels if channel.startswith(pedal)]
