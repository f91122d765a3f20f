"""The parameters and the state of the gateway, and whether a circuit measures what can be.

The transducer is compared with the inverter, and with the wheel that the circuit stands for.
"""

from dataclasses import dataclass
from math import ceil

from ev_bench.bus.checking import CheckState
from ev_bench.bus.parameters import BusParameters
from ev_core.law import WHEEL_NAMES, ParameterError, compilable, group, parameter, setting
from ev_core.parameters.record import entry, part, series
from ev_msgs_py.can.frames import FAULTS, LONG_AGO, RPM, SetPointLayout, names_of
from ev_msgs_py.can.payload import rounded_down


@dataclass(slots=True)
class Feedback:
    """The newest feedback of an inverter, as it arrived."""

    motion: CheckState = part(CheckState)
    electrical: CheckState = part(CheckState)
    temperatures: CheckState = part(CheckState)
    faults: CheckState = part(CheckState)
    heard: float = entry(unit="1", about="whether a frame with its state has come in this cycle, valid or not")
    age: float = entry(LONG_AGO, unit="s", about="of the newest valid frame with its state")
    refused: float = entry(unit="1", about="frames with a wrong CRC or counter")
    lost: float = entry(unit="1", about="lost frames, by their counters")
    state: float = entry(unit="1", about="place in STATE_NAMES")
    remote: float = entry(1.0, unit="1", about="whether it reports that it follows its controlword")
    torque: float = entry(unit="N m", about="at the shaft")
    torque_sum: float = entry(unit="N m", about="of all torques since the last look at what is plausible")
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
    enable: float = entry(unit="1", about="whether it shall be enabled")
    tripped: float = entry(unit="1", about="latched: it was in a fault while it was to be enabled")
    stale: float = entry(unit="1", about="latched: its feedback stayed away")
    command_stale: float = entry(unit="1", about="latched: the command for it stayed away")
    implausible: float = entry(unit="1", about="latched: its circuit measures what cannot be, see `plausibility`")
    doubtful_time: float = entry(unit="s", about="since when what is measured cannot be")
    watched_speed: float = entry(unit="rad/s", about="that the transducer showed at the last look")
    command_age: float = entry(LONG_AGO, unit="s")
    reset_time: float = entry(-1.0, unit="s", about="since the reset sequence began; -1: there is none")
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
        about="for the first moment at which the drives may be enabled by themselves, 1 and the cycles for one alone",
    )
    commanded: float = entry(-1.0, unit="ns", about="stamp of the newest torque command, in real time")
    heartbeat_counters: list[float] = series(2, unit="1", about="of the next heartbeat of each circuit")


OWN_FAULTS = ("StaleFeedback", "StaleCommand", "Implausible")  # of the gateway, in the bits above those of FAULTS


@compilable
def latched(s: Device) -> int:
    """The bits of all faults that are latched, in the inverter and in the gateway."""
    own = int(s.stale) + 2 * int(s.command_stale) + 4 * int(s.implausible)
    return int(s.feedback.fault_bits) | own << len(FAULTS)


def latched_names(bits: int) -> tuple[str, ...]:
    """The names of faults in the bits of `latched`."""
    return (*names_of(bits), *(name for place, name in enumerate(OWN_FAULTS) if bits >> (len(FAULTS) + place) & 1))


@dataclass(frozen=True, slots=True)
class PlausibilityParameters:
    """How far apart two measurements of the same may be, and how long."""

    torque: float = parameter(
        30.0, unit="N m", low=1.0, high=1000.0, source="assumption: above what swings and is noise",
        about="at the shaft, between transducer and inverter",
    )  # fmt: skip
    speed: float = parameter(
        30.0, unit="rad/s", low=1.0, high=1000.0, source="assumption: above what the load machine lags behind",
        about="of the shaft, between transducer and the virtual car's wheel",
    )  # fmt: skip
    time: float = setting(0.01, unit="s", low=0.001, high=1.0, about="for longer than this: fault of that drive")


@compilable
def watch(
    p: PlausibilityParameters, s: Device, rotor: float, torque: float, speed: float, wheel: float, period: float
) -> None:
    """Note for how long torque [N m] and speed [rad/s] of the transducer have been far from inverter and wheel.

    The transducer sits behind the rotor [kg m^2], and shows the mean of a period, as the feedback in it is averaged.
    It is latched while the drive is to be enabled, and before that keeps it from being enabled.
    """
    f = s.feedback
    reported = f.torque_sum / f.torque_count if f.torque_count > 0.0 else f.torque
    # Until it is enabled, a shaft that the load machine still brings to its speed is in doubt, too.
    inside = torque + (rotor * (speed - s.watched_speed) / period if s.enable != 0.0 else 0.0)
    f.torque_sum, f.torque_count, s.watched_speed = 0.0, 0.0, speed
    apart = abs(inside - reported) > p.torque or abs(speed - wheel) > p.speed
    s.doubtful_time = s.doubtful_time + period if apart else 0.0
    if s.enable != 0.0 and s.doubtful_time >= p.time - 0.5 * period:
        s.implausible = 1.0


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
        7500.0 * RPM,
        unit="rad/s",
        low=0.0,
        high=1047.0,
        about="of the shafts, in every mode",
        source="dissertation, table 1.1",
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


@compilable
def most_torque(layout: SetPointLayout, limit: float) -> float:
    """The largest torque within a limit [N m] that a set-point can both ask for and limit."""
    return rounded_down(layout.torque, rounded_down(layout.torque_limit, limit))


def check_limits(layout: SetPointLayout, p: GatewayParameters) -> None:
    """Refuse limits that are above zero and zero in the frames: the drive would be enabled and give nothing."""
    of_torque = layout.torque_limit.scale
    of_torque *= max(ceil(layout.torque.scale / of_torque), 1)
    for name, value, unit, most, least in (
        ("torque_limit", p.torque_limit, "N m", most_torque(layout, p.torque_limit), of_torque),
        ("load_torque_limit", p.load_torque_limit, "N m", most_torque(layout, p.load_torque_limit), of_torque),
        (
            "speed_limit",
            p.speed_limit,
            "rad/s",
            rounded_down(layout.speed, p.speed_limit / RPM),
            layout.speed.scale * RPM,
        ),
    ):
        if value > 0.0 and most <= 0.0:
            raise ParameterError(
                f"{name}: {value!r} is refused, expected 0 or at least {least:.4g} {unit}, the step of the frames", name
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
