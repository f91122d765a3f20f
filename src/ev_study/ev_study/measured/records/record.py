"""Records of measured signals, at equally spaced instants at the centre of mass, and where they are not believed.

How it works: sensors have clocks, places and units of their own. `measured` drops samples that
cannot be right, takes the clock of the yaw rate for all, interpolates the others to it, moves
velocities and accelerations to the centre of mass, and marks in `valid` where any of them is not
believed. Short gaps are bridged, long ones are masked: whatever reads the record restarts behind
them.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from ev_core.parameters.declaration import parameter, setting
from ev_msgs_py.contract.fields import shape_of
from ev_msgs_py.contract.topics import TOPICS
from ev_msgs_py.refusal import ParameterError, quoted, unknown_name
from ev_stack.measures.metric import stretches
from ev_study.measured.records import stopped_sensors
from ev_study.measured.records.samples import (
    Sampled,
    cut,
    in_order,
    jumps,
    spacing_of,
    without_spikes,
)

YAW_RATE, LATERAL, LONGITUDINAL = "twist.yaw_rate", "twist.lateral", "twist.longitudinal"
LATERAL_ACCELERATION, LONGITUDINAL_ACCELERATION = (
    "imu.lateral_acceleration",
    "imu.longitudinal_acceleration",
)
ROAD_WHEEL_ANGLE, STEERING_WHEEL_ANGLE = (
    "steering_column.state.road_wheel_angle",
    "steering_column.state.angle",
)
SIDESLIP = "sideslip"  # [rad], which no topic has

# Factor from a unit to SI; temperatures stay in degC, as the contract has them.
UNITS = {
    "": 1.0,  # SI
    **{
        "1": 1.0,
        "s": 1.0,
        "ms": 1e-3,
        "us": 1e-6,
        "m": 1.0,
        "m/s": 1.0,
        "km/h": 1 / 3.6,
        "mph": 0.44704,
    },
    **{"rad": 1.0, "deg": np.pi / 180, "rad/s": 1.0, "deg/s": np.pi / 180, "rpm": np.pi / 30},
    **{
        "m/s2": 1.0,
        "g": 9.80665,
        "N": 1.0,
        "kN": 1e3,
        "N m": 1.0,
        "degC": 1.0,
        "kPa": 1e3,
        "cm": 1e-2,
        "W": 1.0,
    },
}
# What noise makes of one instant and the next, and how fast a car changes it: both together are
# more than any car does.
_LARGEST_STEP = {
    **dict.fromkeys((YAW_RATE, "imu.yaw_rate"), (1.0, 20.0)),  # [rad/s], [rad/s^2]
    **dict.fromkeys((LONGITUDINAL, LATERAL), (3.0, 30.0)),  # [m/s], [m/s^2]
    # [m/s^2], [m/s^3]
    **dict.fromkeys((LONGITUDINAL_ACCELERATION, LATERAL_ACCELERATION), (40.0, 0.0)),
}
# times as fast as a steering angle may change: a log that holds each sample for some instants is
# slower
_SURE = 3.0
_LEFT_OUT = (
    1.0  # [s] by which channels may begin or end apart without a word: loggers start one by one
)
SLOWEST = 1.0  # [m/s], below which nothing is made of a sideslip angle
# to the centre of mass
_MOVED = (LONGITUDINAL, LATERAL, LONGITUDINAL_ACCELERATION, LATERAL_ACCELERATION, SIDESLIP)
# of a rigid body; a place may be given and changes nothing
_SAME_EVERYWHERE = (YAW_RATE, "imu.yaw_rate")
# To the left, or about the vertical axis: of the other sign where y is to the right and z down.
_FLIPPED = {SIDESLIP} | {
    channel
    for signal, topic in TOPICS.items()
    for channel, is_lateral in zip(topic.channels, shape_of(signal).lateral, strict=True)
    if is_lateral
}


@dataclass(frozen=True, slots=True)
class ColumnParameters:
    """Meaning of a column of a record."""

    column: str = setting(
        "", about="name in the header of the file; of a bag TOPIC:FIELD, such as /imu:angular_velocity.z; of a CAN log "
        "MESSAGE.SIGNAL"
    )  # fmt: skip
    unit: str = setting(
        "",
        choices=tuple(UNITS),
        about="of the numbers of the column; empty: that of the DBC or of a row of units, else SI",
    )
    sign: float = setting(
        1.0,
        unit="1",
        low=-1.0,
        high=1.0,
        about="-1 for a sensor that is mounted the other way round",
    )
    frame: str = setting(
        "iso",
        choices=("iso", "sae"),
        about="axes; iso: y to the left, z up (REP-103); sae: y to the right, z down",
    )
    x: float = setting(
        0.0, unit="m", low=-20.0, high=20.0, about="of the sensor, ahead of the centre of mass"
    )
    y: float = setting(
        0.0, unit="m", low=-5.0, high=5.0, about="of the sensor, left of the centre of mass"
    )
    radius: float = setting(
        0.0,
        unit="m",
        low=0.0,
        high=2.0,
        about="of a wheel with a speed in km/h, mph or m/s; 0: it is in rad/s",
    )
    noise: float = setting(
        0.0, unit="1", low=0.0, high=1e6, about="standard deviation of the numbers of the column, in their unit: a fit "
        "weighs no error by less; 0 for that of a good sensor"
    )  # fmt: skip

    def __post_init__(self) -> None:
        if abs(self.sign) != 1.0:
            raise ParameterError(f"sign is {self.sign:g}, expected 1 or -1")

    def factor(self, channel: str) -> float:
        """Factor from the numbers of the column to SI and REP-103."""
        # A speed over the radius of the wheel is its angular velocity.
        factor = UNITS[self.unit] / self.radius if self.radius else UNITS[self.unit]
        return factor * self.sign * (-1.0 if self.frame == "sae" and channel in _FLIPPED else 1.0)


@dataclass(frozen=True, slots=True)
class MaskParameters:
    """Limits beyond which a record is not believed."""

    steering_rate: float = parameter(
        3.0,
        unit="rad/s",
        low=0.01,
        high=100.0,
        about=(
            "of the road wheels, of the steering wheel 16 times as much; a faster change is a jump"
        ),
    )
    bridge: float = parameter(
        0.05,
        unit="s",
        low=0.0,
        high=1.0,
        about="of jumps and gaps up to this length the inputs are interpolated",
    )


class Read(NamedTuple):
    """Columns by name, as a reader has found them, and SHA-256 of the file, empty of a folder.

    `units` are those that the file has, as it writes them, by column; `notes` are about what was
    passed over.
    """

    columns: dict[str, Sampled]
    digest: str = ""
    units: Mapping[str, str] = MappingProxyType({})
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class MeasuredRecord:
    """Signals over equally spaced instants from time zero on, at the centre of mass, in SI and REP-103.

    `channels` have the names of signals.npz and `SIDESLIP`, (n,) each. `valid` (n,) marks the
    instants that are believed; elsewhere channels hold interpolated numbers. `begin` [s] is the
    time of the file at the first instant. `noise` is the declared standard deviation by channel,
    where there is one, and `spacing` how far the samples of its sensor are apart [s]. The sideslip
    angle is NaN where the car is slower than `SLOWEST`: noise of the velocities decides it there.
    """

    source: str
    digest: str
    begin: float
    period: float
    channels: Mapping[str, np.ndarray]
    valid: np.ndarray
    notes: tuple[str, ...] = ()
    noise: Mapping[str, float] = field(default_factory=dict)
    spacing: Mapping[str, float] = field(default_factory=dict)

    @property
    def time(self) -> np.ndarray:
        """The instants in the time of the file [s]."""
        return self.begin + self.period * np.arange(len(self.valid))

    @property
    def stretches(self) -> list[slice]:
        """The instants in a row that are believed: behind a mask another drive may begin."""
        return stretches(self.valid)

    def noted(self, notes: tuple[str, ...]) -> MeasuredRecord:
        """The same with further notes."""
        return replace(self, notes=self.notes + notes)

    def __getitem__(self, channel: str) -> np.ndarray:
        """A channel; ParameterError if the record does not have it."""
        if channel not in self.channels:
            raise unknown_name(f"channel of {self.source}", channel, self.channels)
        return self.channels[channel]


def measured(
    source: str,
    digest: str,
    columns: Mapping[str, tuple[Sampled, ColumnParameters]],
    mask: MaskParameters,
) -> MeasuredRecord:
    """The record of columns in SI and REP-103, at the places of their sensors, each over its own times.

    Its instants are as far apart as the samples of the yaw rate, or of the first column, from the
    instant on at which all columns have begun to that at which the first ends. Samples at times
    that do not increase are passed over. ParameterError if there are no such instants, or if most
    of the times do not increase.
    """
    if not columns:
        raise ParameterError(f"{source}: no channel of it is known")
    # Phase 1: times first, since a jump is a matter of the time between two samples.
    samples, passed_over, set_back = in_order(
        source, {name: each for name, (each, _) in columns.items()}
    )
    samples, spikes, for_good = without_spikes(samples, _LARGEST_STEP)
    columns = {name: (samples[name], declared) for name, (_, declared) in columns.items()}
    for name, (each, _) in columns.items():
        # np.interp needs two points.
        if np.isfinite(each.values).sum() < 2:
            raise ParameterError(f"{source}: {name} has less than two finite numbers")
    # Phase 2: one clock. The yaw rate has it: no replay is without one.
    clock = columns.get(YAW_RATE, next(iter(columns.values())))[0].time
    step = spacing_of(clock).interval
    # Whole microseconds: the mean of a logger's steps has digits that no clock has.
    period = round(step, 6)
    if not period:
        raise ParameterError(
            f"{source}: samples are {step:.3g} s apart, expected 1e-06 s or more: unit of the time?"
        )
    # The time that all channels have in common.
    begin, end = (
        pick(each.time[n] for each, _ in columns.values()) for pick, n in ((max, 0), (min, -1))
    )
    # Rounded, and one more since both ends count.
    instants = np.arange(int((end - begin) / period + 1.5) if end > begin else 0) * period
    if len(instants) < 2:
        raise ParameterError(f"{source}: its channels have no time in common")
    channels, valid = {}, np.ones(len(instants), bool)
    for name, (each, _) in columns.items():
        # Phase 3: every channel to the instants of the clock, over its own gaps as well ...
        time, finite = each.time - begin, np.isfinite(each.values)
        channels[name] = np.interp(instants, time[finite], each.values[finite])
        # ... where it is not believed: an instant counts only between two samples with numbers.
        valid &= np.interp(instants, time, finite) == 1.0
        # The last sample up to an instant; 1e-9 s let a sample at the very instant be it.
        before = np.clip(np.searchsorted(time, instants + 1e-9, side="right") - 1, 0, len(time) - 2)
        # Half an interval more than usual is a missing sample. A slow sensor is held to its own
        # interval.
        apart = 1.5 * max(spacing_of(time).largest, period)
        valid &= (time[before + 1] - time[before] < apart) | (
            # An instant right on a sample needs no neighbour.
            np.abs(time[before] - instants) < 1e-6
        )
    # Phase 4: after all are on one clock, since the yaw rate moves the others.
    _move_to_centre(channels, {name: declared for name, (_, declared) in columns.items()}, period)
    for name in (ROAD_WHEEL_ANGLE, STEERING_WHEEL_ANGLE):
        if name in channels:
            # 16 is the steering ratio of a usual car: the record does not know that of this one.
            limit = mask.steering_rate * (16.0 if name == STEERING_WHEEL_ANGLE else 1.0)
            valid &= ~jumps(channels[name], limit * period, sure=_SURE)[0]
    still = _stopped(samples, channels, begin + instants)
    for each in still.values():
        valid &= ~each
    # Never bridged: what lies behind belongs to another clock or another level.
    is_cut = cut(instants + begin, [*set_back, *for_good])
    valid &= ~is_cut
    notes = (
        passed_over
        + spikes
        + _left_out(samples, begin, end)
        + stopped_sensors.in_words(still, period)
        + _bridge(channels, valid, is_cut, max(int(mask.bridge / period + 0.5), 0))
    )
    noise = {
        name: declared.noise * abs(declared.factor(name))
        for name, (_, declared) in columns.items()
        if declared.noise
    }
    found = {name: spacing_of(each.time) for name, (each, _) in columns.items()}
    spacing = {name: each.interval for name, each in found.items()}
    if bursts := [name for name, each in found.items() if each.is_in_bursts]:
        most = max(found[name].largest for name in bursts)
        notes += (
            (
                f"{', '.join(bursts)}: samples come in bursts, up to {most:.2g} s apart: their"
                " times are those of arrival"
            ),
        )
    _complete_sideslip(channels, noise, spacing)
    return MeasuredRecord(
        source, digest, float(begin), period, channels, valid, notes, noise, spacing
    )


def _left_out(samples: Mapping[str, Sampled], begin: float, end: float) -> tuple[str, ...]:
    """The line on channels that begin late or end early, by which a record is shorter than its others."""
    first = min(each.time[0] for each in samples.values())
    last = max(each.time[-1] for each in samples.values())
    # Those that make the record shorter, not those that are longer than it.
    late = [name for name, each in samples.items() if each.time[0] > first + _LEFT_OUT]
    early = [name for name, each in samples.items() if each.time[-1] < last - _LEFT_OUT]
    if not late and not early:
        return ()
    which = "; ".join(
        f"{', '.join(names)} {what}"
        for names, what in ((late, "begins late"), (early, "ends early"))
        if names
    )
    return (
        (
            f"of {first:.2f} to {last:.2f} s only {begin:.2f} to {end:.2f} s count, in which all"
            f" channels are there ({which}): a mapping without them has the rest"
        ),
    )


def _stopped(
    samples: Mapping[str, Sampled], channels: Mapping[str, np.ndarray], instants: np.ndarray
) -> dict[str, np.ndarray]:
    """Mark by channel where its sensor shows one number though the car turns, (n,) bool."""
    if LONGITUDINAL not in channels:
        return {}
    speed = channels[LONGITUDINAL]
    followed: dict[str, np.ndarray] = {}
    for angle in (ROAD_WHEEL_ANGLE, STEERING_WHEEL_ANGLE):
        # The yaw rate follows speed times steering angle, whatever the scale: only movement counts
        # here.
        if angle in channels:
            followed |= dict.fromkeys(_SAME_EVERYWHERE, speed * channels[angle])
    if YAW_RATE in channels:
        followed |= dict.fromkeys((LATERAL, SIDESLIP), channels[YAW_RATE])
        followed[LATERAL_ACCELERATION] = speed * channels[YAW_RATE]
    return {
        name: stopped_sensors.stopped(samples[name], by, speed, instants)
        for name, by in followed.items()
        if name in samples
    }


def _complete_sideslip(
    channels: dict[str, np.ndarray], noise: dict[str, float], spacing: dict[str, float]
) -> None:
    """Sideslip angle and lateral velocity by each other, and no sideslip angle where the car hardly moves."""
    if LONGITUDINAL not in channels:
        return
    speed = channels[LONGITUDINAL]
    moves = np.abs(speed) >= SLOWEST
    # The ratio of both noises depends on the speed: that of the median instant that moves.
    typical = float(np.median(np.abs(speed[moves]))) if moves.any() else SLOWEST
    if SIDESLIP not in channels and LATERAL in channels:
        channels[SIDESLIP] = sideslip(speed, channels[LATERAL], speed)
        if LATERAL in noise:
            noise[SIDESLIP] = noise[LATERAL] / typical
    elif SIDESLIP in channels and LATERAL not in channels:
        channels[LATERAL] = speed * np.tan(channels[SIDESLIP])
        spacing[LATERAL] = spacing[SIDESLIP]
        if SIDESLIP in noise:
            noise[LATERAL] = noise[SIDESLIP] * typical
    if SIDESLIP in channels:
        channels[SIDESLIP] = np.where(moves, channels[SIDESLIP], np.nan)


def sideslip(longitudinal: np.ndarray, lateral: np.ndarray, measured: np.ndarray) -> np.ndarray:
    """The sideslip angle [rad] by velocities in the body frame, in reverse that of the rear, as in `measures.motion`.

    The car reverses where the `measured` longitudinal velocity is negative, so that a simulated car
    that has turned round does not.
    """
    # In reverse both components turn round, so that the angle is about 0 and not about pi.
    direction = np.where(measured < 0.0, -1.0, 1.0)
    return np.arctan2(direction * lateral, direction * longitudinal)


def _move_to_centre(
    channels: dict[str, np.ndarray], declared: Mapping[str, ColumnParameters], period: float
) -> None:
    """Velocities, accelerations and sideslip beside the centre of mass, of a rigid body that turns in the plane."""
    moved = [n for n, of in declared.items() if of.x or of.y]
    # last: it needs the velocity at the centre of mass
    moved.sort(key=lambda name: name == SIDESLIP)
    for name in moved:
        if name in _SAME_EVERYWHERE:
            continue
        if name not in _MOVED:
            raise ParameterError(f"{name}: x and y are refused, expected for {', '.join(_MOVED)}")
        needed = (YAW_RATE, LONGITUDINAL) if name == SIDESLIP else (YAW_RATE,)
        for each in needed:
            if each not in channels:
                raise ParameterError(
                    f"{name} was measured beside the centre of mass, which needs {each}"
                )
        # v_P = v + r x (x, y), so v = v_P less that; a_P likewise with its centripetal part -r^2
        # (x, y).
        x, y, yaw_rate = declared[name].x, declared[name].y, channels[YAW_RATE]
        yaw = np.gradient(yaw_rate, period)
        if name == SIDESLIP:
            channels[name] = _sideslip_at_centre(
                channels[name], channels[LONGITUDINAL], yaw_rate, x, y
            )
            continue
        channels[name] = (
            channels[name]
            + {
                LONGITUDINAL: y * yaw_rate,
                LATERAL: -x * yaw_rate,
                LONGITUDINAL_ACCELERATION: x * yaw_rate**2 + y * yaw,
                LATERAL_ACCELERATION: -x * yaw + y * yaw_rate**2,
            }[name]
        )


def _sideslip_at_centre(
    angle: np.ndarray, speed: np.ndarray, yaw_rate: np.ndarray, x: float, y: float
) -> np.ndarray:
    """The sideslip angle [rad] of a sensor at (x, y), by its velocity, less that of the turn."""
    return sideslip(speed, (speed - y * yaw_rate) * np.tan(angle) - x * yaw_rate, speed)


def _bridge(
    channels: dict[str, np.ndarray], valid: np.ndarray, is_cut: np.ndarray, most: int
) -> tuple[str, ...]:
    """Interpolate all channels where they are not believed.

    What is short and no cut is believed then.
    """
    bad = np.flatnonzero(~valid)
    if not len(bad):
        return ()
    good = np.flatnonzero(valid)
    if len(good) < 2:
        raise ParameterError("the record has less than two instants that are believed")
    for name, values in channels.items():
        channels[name] = values.copy()
        channels[name][bad] = np.interp(bad, good, values[good])
    # Instants in a row make one gap.
    runs = np.split(bad, np.flatnonzero(np.diff(bad) > 1) + 1)
    bridged = [run for run in runs if len(run) <= most and not is_cut[run].any()]
    for run in bridged:
        valid[run] = True
    masked = len(runs) - len(bridged)
    return (
        (
            f"{len(bad)} instants in {len(runs)} jumps and gaps, {len(bridged)} of them bridged,"
            f" {masked} masked"
        ),
    )


def quoted_source(record: MeasuredRecord) -> str:
    """The name of the file and the beginning of its hash."""
    return (
        f"{Path(record.source).name}, SHA-256 {record.digest[:12]}"
        if record.digest
        else quoted(record.source)
    )
