"""Parameters and state of the gateway, and a check of what its circuits measure.

The transducer is compared with the inverter, and with the wheel that the circuit stands for.
"""

from dataclasses import dataclass
from enum import auto
from math import ceil
from typing import NamedTuple

from ev_bench.bus.checking import CheckState
from ev_bench.bus.parameters import BusParameters
from ev_core.law import WHEEL_NAMES, Choice, ParameterError, compilable, group, parameter, setting
from ev_core.parameters.record import entry, part, series
from ev_msgs_py.can.frames import FAULTS, LONG_AGO, RPM, SetPointLayout, names_of
from ev_msgs_py.can.payload import rounded_down

# Faults of the gateway itself, in the bits above those of FAULTS.
OWN_FAULTS = ("StaleFeedback", "StaleCommand", "Implausible")


class Stops(Choice):
    """Drives that a fault of one of them disables."""

    DRIVE = auto()
    BOTH = auto()


@dataclass(slots=True)
class Feedback:
    """The newest feedback of an inverter, as it arrived."""

    motion: CheckState = part(CheckState)
    electrical: CheckState = part(CheckState)
    temperatures: CheckState = part(CheckState)
    faults: CheckState = part(CheckState)
    received: bool = entry(
        False, unit="1", about="whether a frame with its state has come in this cycle, valid or not"
    )
    age: float = entry(LONG_AGO, unit="s", about="of the newest valid frame with its state")
    refused: float = entry(unit="1", about="frames with a wrong CRC or counter")
    lost: float = entry(unit="1", about="lost frames, by their counters")
    state: float = entry(unit="1", about="place in STATE_NAMES")
    remote: bool = entry(True, unit="1", about="whether it reports that it follows its controlword")
    torque: float = entry(unit="N m", about="at the shaft")
    torque_sum: float = entry(
        unit="N m", about="of all torques since the last look at what is plausible"
    )
    torque_count: float = entry(unit="1", about="how many there were")
    speed: float = entry(unit="rad/s", about="of the shaft")
    dc_voltage: float = entry(unit="V")
    dc_current: float = entry(unit="A", about="from the supply")
    phase_current: float = entry(unit="A", about="rms")
    winding_temperature: float = entry(unit="degC")
    inverter_temperature: float = entry(unit="degC")
    fault_bits: float = entry(unit="1", about="by place in FAULTS")
    warning_bits: float = entry(unit="1", about="by place in WARNINGS")
    error_code: float = entry(unit="1")


@dataclass(slots=True)
class Device:
    """One inverter as the gateway leads it."""

    feedback: Feedback = part(Feedback)
    enable: bool = entry(False, unit="1", about="whether it shall be enabled")
    tripped: bool = entry(
        False, unit="1", about="latched: it was in a fault while it was to be enabled"
    )
    stale: bool = entry(False, unit="1", about="latched: its feedback stayed away")
    command_stale: bool = entry(False, unit="1", about="latched: the command for it stayed away")
    implausible: bool = entry(
        False, unit="1", about="latched: its circuit measures what cannot be, see `plausibility`"
    )
    doubtful_time: float = entry(unit="s", about="since when what is measured cannot be")
    watched_speed: float = entry(unit="rad/s", about="that the transducer showed at the last look")
    command_age: float = entry(LONG_AGO, unit="s")
    reset_time: float = entry(
        -1.0, unit="s", about="since the reset sequence began; -1: there is none"
    )
    mode: float = entry(unit="1", about="as in the set-point frame")
    torque: float = entry(unit="N m", about="set-point, at the shaft")
    speed: float = entry(unit="rad/s", about="set-point of speed mode")
    counter: float = entry(unit="1", about="of the next set-point")


@dataclass(slots=True)
class Gateway:
    """All four inverters."""

    drive_11: Device = part(Device)
    drive_12: Device = part(Device)
    load_11: Device = part(Device)
    load_12: Device = part(Device)
    tick: float = entry(unit="1", about="cycles of 1 ms since the start")
    waits: float = entry(
        unit="1",
        about="for the first moment at which the drives may be enabled by themselves, 1 and the "
        "cycles for one alone",
    )
    waited: float = entry(unit="s", about="for that moment, in all")
    commanded: float = entry(
        -1.0, unit="ns", about="stamp of the newest torque command, in real time"
    )
    heartbeat_counters: list[float] = series(
        2, unit="1", about="of the next heartbeat of each circuit"
    )


@compilable
def latched(s: Device) -> int:
    """Bits of all faults that are latched, in the inverter and in the gateway."""
    own = int(s.stale) + 2 * int(s.command_stale) + 4 * int(s.implausible)
    return int(s.feedback.fault_bits) | own << len(FAULTS)


def latched_names(bits: int) -> tuple[str, ...]:
    """Names of the faults in the bits of `latched`."""
    own = bits >> len(FAULTS)
    latched_here = tuple(name for place, name in enumerate(OWN_FAULTS) if own >> place & 1)
    return (*names_of(bits), *latched_here)


@dataclass(frozen=True, slots=True)
class PlausibilityParameters:
    """Distance of two measurements of the same that is allowed, and for how long."""

    torque: float = parameter(
        30.0,
        unit="N m",
        low=1.0,
        high=1000.0,
        source="assumption: above what swings and is noise",
        about="at the shaft, between transducer and inverter",
    )
    speed: float = parameter(
        30.0,
        unit="rad/s",
        low=1.0,
        high=1000.0,
        source="assumption: above what the load machine lags behind",
        about="of the shaft, between transducer and the virtual car's wheel",
    )
    time: float = setting(
        0.01, unit="s", low=0.001, high=1.0, about="for longer than this: fault of that drive"
    )


class Shaft(NamedTuple):
    """Measurements of a shaft by the transducer behind it, and what it stands for."""

    rotor: float  # inertia of the rotor in front of the transducer [kg m^2]
    torque: float  # mean of a period [N m]
    speed: float  # [rad/s]
    wheel: float  # speed of the virtual car's wheel, at the shaft [rad/s]


@compilable
def watch(p: PlausibilityParameters, s: Device, shaft: Shaft, period: float) -> None:
    """Count for how long the transducer has been far from the inverter and from the wheel.

    The transducer shows the mean of a period, as the feedback in it is averaged. A doubt that lasts
    is latched while the drive is to be enabled, and before that keeps it from being enabled.
    """
    f = s.feedback
    reported = f.torque_sum / f.torque_count if f.torque_count > 0.0 else f.torque
    # Until it is enabled, a shaft that the load machine still brings to its speed is in doubt, too.
    change = shaft.speed - s.watched_speed
    # The transducer sits behind the rotor: the torque in front of it also speeds the rotor up.
    inside = shaft.torque + (shaft.rotor * change / period if s.enable else 0.0)
    f.torque_sum = 0.0
    f.torque_count = 0.0
    s.watched_speed = shaft.speed
    apart = abs(inside - reported) > p.torque or abs(shaft.speed - shaft.wheel) > p.speed
    s.doubtful_time = s.doubtful_time + period if apart else 0.0
    # Half a period less, so that it does not depend on how the sum was rounded.
    if s.enable and s.doubtful_time >= p.time - 0.5 * period:
        s.implausible = True


@dataclass(frozen=True, slots=True)
class GatewayParameters:
    """Limits, time-outs, and the wheels of the circuits."""

    gear_ratio: float = parameter(
        7.4,
        unit="1",
        low=0.01,
        high=100.0,
        about="motor over wheel speed",
        source="dissertation, table 2.1",
    )
    wheel_11: str = setting(
        "front_right", choices=WHEEL_NAMES, about="the wheel of the right circuit"
    )
    wheel_12: str = setting(
        "front_left", choices=WHEEL_NAMES, about="the wheel of the left circuit"
    )
    torque_limit: float = parameter(
        360.0,
        unit="N m",
        low=0.0,
        high=1000.0,
        about="at the shaft of a drive",
        source="dissertation, table 1.1",
    )
    load_torque_limit: float = setting(
        400.0, unit="N m", low=0.0, high=1000.0, about="at the shaft of a load machine"
    )
    speed_limit: float = parameter(
        7500.0 * RPM,
        unit="rad/s",
        low=0.0,
        high=1047.0,
        about="of the shafts, in every mode",
        source="dissertation, table 1.1",
    )
    feedback_timeout: float = setting(
        0.01,
        unit="s",
        low=0.001,
        high=1.0,
        about="without valid feedback for longer than this: fault of that drive",
    )
    command_timeout: float = setting(
        0.1,
        unit="s",
        low=0.001,
        high=60.0,
        about="without a command for longer than this: fault of its drives",
    )
    reset_timeout: float = setting(
        0.2, unit="s", low=0.01, high=10.0, about="longest reset sequence"
    )
    fault_stops: Stops = setting(
        Stops.DRIVE, about="whether a fault of one drive also disables the other"
    )
    auto_enable: bool = setting(
        False,
        about="enable the drives once by itself, as soon as feedback and commands are there",
        read_only=True,
    )
    bus: BusParameters = group(BusParameters)

    def __post_init__(self) -> None:
        if self.wheel_11 == self.wheel_12:
            raise ParameterError(
                f"wheel_12: {self.wheel_12!r} is refused, it is the wheel of the other circuit "
                f"already"
            )


@compilable
def most_torque(layout: SetPointLayout, limit: float) -> float:
    """Largest torque within a limit [N m] that a set-point can both ask for and limit."""
    return rounded_down(layout.torque, rounded_down(layout.torque_limit, limit))


def check_limits(layout: SetPointLayout, p: GatewayParameters) -> None:
    """Refuse limits above zero that are zero in the frames: an enabled drive would give nothing."""
    of_torque = layout.torque_limit.scale
    # A limit is rounded down to both steps, so the coarser one decides what is left of it.
    of_torque *= max(ceil(layout.torque.scale / of_torque), 1)
    for name in ("torque_limit", "load_torque_limit"):
        limit = getattr(p, name)
        _refuse_zero(name, limit, most_torque(layout, limit), f"{of_torque:.4g} N m")
    most_speed = rounded_down(layout.speed, p.speed_limit / RPM)
    of_speed = layout.speed.scale * RPM
    _refuse_zero("speed_limit", p.speed_limit, most_speed, f"{of_speed:.4g} rad/s")


def _refuse_zero(name: str, limit: float, most: float, least: str) -> None:
    """ParameterError for a limit above zero of which the frames leave nothing."""
    if limit > 0.0 and most <= 0.0:
        wanted = f"0 or at least {least}, the step of the frames"
        raise ParameterError(f"{name}: {limit!r} is refused, expected {wanted}", name)


@dataclass(frozen=True, slots=True)
class LockstepGatewayParameters(GatewayParameters):
    """Parameters of the gateway, and instants at which its buttons are pressed."""

    auto_enable: bool = setting(
        True,
        about="enable the drives once by itself, as soon as feedback and commands are there",
        read_only=True,
    )
    plausibility: PlausibilityParameters = group(PlausibilityParameters)
    enable_at: float = setting(
        -1.0,
        unit="s",
        low=-1.0,
        high=1e5,
        about="instant at which both drives are enabled by hand; -1: never",
    )
    reset_at: float = setting(
        -1.0,
        unit="s",
        low=-1.0,
        high=1e5,
        about="instant of a reset by hand, with enabling after it; -1: never",
    )
