"""How the gateway speaks for the controller."""

from __future__ import annotations

from dataclasses import dataclass

from ev_control.inverter_gateway.plausibility import PlausibilityParameters
from ev_core.bus.parameters import BusParameters
from ev_core.law import WHEEL_NAMES, ParameterError, group, parameter, setting

STOPS = ("drive", "both")
ONE, BOTH = range(len(STOPS))


@dataclass(frozen=True, slots=True)
class GatewayParameters:
    """Limits, time-outs and which wheel is whose."""

    gear_ratio: float = parameter(
        7.4, unit="1", low=0.01, high=100.0, about="motor over wheel speed", source="dissertation, table 2.1"
    )
    wheel_11: str = setting("front_right", choices=WHEEL_NAMES, about="the wheel of the right circuit")
    wheel_12: str = setting("front_left", choices=WHEEL_NAMES, about="the wheel of the left circuit")
    torque_limit: float = parameter(
        360.0, unit="N m", low=0.0, high=1000.0, about="at the shaft of a drive", source="dissertation, table 1.1"
    )
    load_torque_limit: float = setting(400.0, unit="N m", low=0.0, high=1000.0, about="at the shaft of a load machine")
    speed_limit: float = parameter(
        785.398, unit="rad/s", low=0.0, high=1047.0, about="of the shafts", source="dissertation, table 1.1"
    )
    feedback_timeout: float = setting(
        0.01, unit="s", low=0.001, high=1.0, about="without valid feedback for longer than this: fault of that drive"
    )
    command_timeout: float = setting(
        0.1, unit="s", low=0.001, high=60.0, about="without a command for longer than this: fault of its drives"
    )
    reset_timeout: float = setting(0.2, unit="s", low=0.01, high=10.0, about="longest reset sequence")
    fault_stops: str = setting("drive", choices=STOPS, about="whether a fault of one drive also disables the other")
    auto_enable: bool = setting(
        False, about="enable the drives once by itself, as soon as feedback and commands are there", read_only=True
    )
    bus: BusParameters = group(BusParameters)

    def __post_init__(self) -> None:
        if self.wheel_11 == self.wheel_12:
            raise ParameterError(
                f"wheel_12: {self.wheel_12!r} is refused, it is the wheel of the other circuit already"
            )


@dataclass(frozen=True, slots=True)
class LockstepGatewayParameters(GatewayParameters):
    """The same, and what somebody does at its buttons."""

    auto_enable: bool = setting(
        True, about="enable the drives once by itself, as soon as feedback and commands are there", read_only=True
    )
    plausibility: PlausibilityParameters = group(PlausibilityParameters)
    enable_at: float = setting(-1.0, unit="s", low=-1.0, high=1e5, about="somebody enables both drives; -1: nobody")
    reset_at: float = setting(
        -1.0, unit="s", low=-1.0, high=1e5, about="somebody begins a reset, with enabling after it; -1: nobody"
    )
