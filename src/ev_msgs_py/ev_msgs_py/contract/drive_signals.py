"""The signals of drives whose speed is controlled."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from ev_msgs_py.contract.field import Field
from ev_msgs_py.contract.wheels import Wheels


class WheelSpeedCommand(NamedTuple):
    """Set-points of drives in speed mode; the torque command is the largest torque that they may use to get there."""

    speed: Annotated[Wheels, Field("rad/s", "of the wheel, forwards positive", "{wheel}.velocity")]
