"""Open-loop replay: windows of a record, begun from the measured state, with measured inputs, through the plant.

How it works: every window of every car is one run of a batch. The parameters of a run hold the
piece of the record that it needs: imposed speed, pedals or torques over time, the steering angle,
and the state to begin from. Each run begins a bit before its window: 0.2 s in which the body is
held at the measured state while wheels and loads settle, or 1 s on the road where no lateral
velocity is known. These samples are cut off again behind the batch.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from ev_core.lockstep.configuration import Configuration
from ev_core.lockstep.graph import check_graph
from ev_msgs_py.contract.wheels import WHEEL_NAMES
from ev_msgs_py.refusal import ParameterError
from ev_stack.batches.batch import batch
from ev_stack.scenarios.about import NAMESPACE
from ev_stack.scenarios.files import vehicle_file
from ev_stack.scenarios.parameter_file import ParameterFile
from ev_stack.scenarios.records import Overrides
from ev_stack.scenarios.sources import Sources
from ev_study.measured.records.record import (
    LATERAL,
    LATERAL_ACCELERATION,
    LONGITUDINAL,
    LONGITUDINAL_ACCELERATION,
    ROAD_WHEEL_ANGLE,
    SIDESLIP,
    SLOWEST,
    STEERING_WHEEL_ANGLE,
    YAW_RATE,
    MeasuredRecord,
    sideslip,
)
from ev_study.measured.replays.smoothing import SMOOTHED, smoothed, with_acceleration

COMPARED = {
    **{YAW_RATE: "rad/s", SIDESLIP: "rad", LATERAL: "m/s", LATERAL_ACCELERATION: "m/s2"},
    **{LONGITUDINAL: "m/s", LONGITUDINAL_ACCELERATION: "m/s2"},
}
# [s], ten times the lag of the loads: wheels, carcasses and loads settle while the body is held
HOLD = 0.2
# [s] that a car drives ahead of a window without a measured lateral velocity, to have its
# own
LEAD = 1.0
# What may drive a car: its speed, what the driver asks for, or the torque of each wheel.
IMPOSED = ("speed", "pedals", "torques")  # besides the angle
FEWEST = 10  # instants of a window, below which a replay has hardly begun
_TORQUES = str(Path(__file__).with_name("imposed_torques.py"))
_PEDALS = {kind: f"driver.command.{kind}_torque" for kind in ("drive", "brake")}
# What a replay needs of each role; files and --set may change all of it but what is refused below.
_OWN: Mapping[str, Mapping[str, Any]] = {
    "plant": {"method": "planar", "speed": "imposed", "imposed_at": "wheels", "initial_hold": HOLD},
    "steering_column": {"method": "imposed"},
    "driver": {"method": "manoeuvre", "pedals.begin": True},
    "electronic_differential": {"method": "equal_torque"},
    "asr": {"method": "off"},
}
ROLES_OF_REPLAY = tuple(_OWN)
# What each window has from the record, by role: parameters, or groups of them.
_OF_RECORD = {
    "plant": (
        "speed",
        "imposed_speed",
        "initial_speed",
        "initial_hold",
        "initial_lateral_velocity",
        "initial_yaw_rate",
    ),
    "steering_column": ("time", "angle"),
    "driver": ("pedals",),
}
_OF_TORQUES = {"electronic_differential": ("time", "drive", "brake")}


@dataclass(frozen=True)
class Windows:
    """Windows of a record: the first instants, (n,), and how many instants a window has.

    `at_rest` counts the windows that were passed over because the car stood.
    """

    first: np.ndarray
    size: int
    at_rest: int = 0

    def __len__(self) -> int:
        """Number of windows."""
        return len(self.first)

    def of(self, values: np.ndarray) -> np.ndarray:
        """A channel in windows, (n, size)."""
        return values[self.first[:, None] + np.arange(self.size)]

    def some(self, chosen: np.ndarray) -> Windows:
        """Those that are marked, or numbered."""
        return Windows(self.first[chosen], self.size, self.at_rest)


def windows_of(
    record: MeasuredRecord, length: float, begin: float = 0.0, end: float = 1.0
) -> Windows:
    """Windows of `length` [s] one behind the other, between two shares of the record's duration.

    A window restarts behind what is masked, or `LEAD` behind it and behind the begin of the record
    where the car has to find its own lateral velocity; one in which the car stands throughout is
    passed over. ParameterError if not one fits.
    """
    least, most = (FEWEST - 1) * record.period, len(record.valid) * record.period
    if most < least:
        raise ParameterError(
            f"{record.source} lasts {most:g} s, expected {least:g} s or more: the unit of the time?"
        )
    if not least <= length <= most:
        what = f"a window of {length:g} s of {record.source} is refused"
        raise ParameterError(f"{what}, expected {least:g} to {most:g} s (--window)")
    # Both ends count as instants of the window.
    size = round(length / record.period) + 1
    lead = 0 if LATERAL in record.channels else round(LEAD / record.period)
    # The lead in front of the first window has to be within the record, too.
    first, place, at_rest = [], max(int(begin * len(record.valid)), lead), 0
    last = int(end * len(record.valid))
    while place + size <= last:
        # The lead counts as well: the car drives through it.
        bad = np.flatnonzero(~record.valid[place - lead : place + size])
        if len(bad):
            # Right behind the last instant that is not believed; the lead is checked anew from
            # there.
            place += int(bad[-1]) + 1
            continue
        if np.abs(record[LONGITUDINAL][place : place + size]).max() >= SLOWEST:
            first.append(place)
        else:
            at_rest += 1
        # The last instant of a window is the first of the next one.
        place += size - 1
    if not first:
        begin, end = (round(share * len(record.valid)) * record.period for share in (begin, end))
        where = f"from {begin:.1f} s to {end:.1f} s of {record.source}"
        standing = f" ({at_rest} in which the car stands)" if at_rest else ""
        expected = "expected a shorter --window or a car that drives"
        raise ParameterError(
            f"no window of {length:g} s without a gap {where}{standing}, {expected}"
        )
    return Windows(np.array(first), size, at_rest)


def graph(
    vehicle: str, period: float, changed: Overrides | None = None, imposed: str = "speed"
) -> dict[str, Configuration]:
    """A car with imposed road-wheel angle and `imposed`, and the rest of its graph, at rest.

    `vehicle` is a name or a path. ParameterError, in one line, for what is refused.
    """
    changed = changed or Overrides()
    files = [vehicle_file(vehicle), *map(ParameterFile, changed.files)]
    # A node that a replay does not have would silently ignore the value.
    for node, key, _ in changed.values:
        if node not in ("*", *_OWN):
            raise ParameterError(
                f"{node}.{key} is refused: an open-loop replay has {', '.join(_OWN)}"
            )
    sources = Sources(NAMESPACE, files, changed)
    configurations = {}
    for role, own in _OWN.items():
        values = {"control_period": period, **own}
        if role == "electronic_differential" and imposed == "torques":
            values["method"] = _TORQUES
        # Later entries win: what was given goes before what a replay has by itself.
        values |= sources.values(role)
        configurations[role] = sources.configured(role, values)
    check_graph(configurations)
    own_period = configurations["plant"].common.control_period
    # Samples of the record are steps of the plant: nothing is interpolated between them.
    if own_period != period:
        raise ParameterError(
            f"control_period is {own_period:g} s, expected that of the record, {period:g} s"
        )
    return configurations


def refuse_own(changed: Overrides, imposed: str) -> None:
    """ParameterError for a single value that a replay has from its record: it would have no effect."""
    of_record = {**_OF_RECORD, **(_OF_TORQUES if imposed == "torques" else {})}
    for node, key, _ in changed.values:
        names = [name for role, of in of_record.items() if node in ("*", role) for name in of]
        if any(key == name or key.startswith(f"{name}.") for name in names):
            raise ParameterError(
                f"{node}.{key} is refused: a replay has it from the record, expected is no such"
                " value"
            )


class OpenLoop:
    """Replays windows of a record for any number of cars at once.

    The car is driven as the record was: road-wheel angle and, by `imposed`, longitudinal velocity,
    pedals or the torque of each wheel. Velocities and yaw rate are those that were measured when
    the window begins, all else follows. The speed that is imposed and what a window begins from are
    smoothed with a `cut_off` [Hz], by their noise for None (`smoothing`), so that noise is no
    force; 0 takes the samples as they are. A car without a measured lateral velocity begins
    `LEAD` before the window with none. `notes` has what was made of speed and torques.
    ParameterError if the record lacks the yaw rate or what is imposed.
    """

    def __init__(
        self,
        record: MeasuredRecord,
        windows: Windows,
        configurations: Mapping[str, Configuration],
        signals: Sequence[str] = (LATERAL, YAW_RATE, LATERAL_ACCELERATION),
        imposed: str = "speed",
        cut_off: float | None = None,
    ) -> None:
        self.record, self.windows = record, windows
        # The longitudinal velocity in any case: the sideslip angle needs it.
        self._signals = (*dict.fromkeys((LONGITUDINAL, *signals)),)
        self.configurations = configurations
        self.is_imposed, self.cut_off, self._imposed = imposed == "speed", cut_off, imposed
        held = LATERAL in record.channels
        self._lead = round((HOLD if held else LEAD) / record.period)
        size = self._lead + windows.size
        # Before a stretch begins, its first instant: behind a mask another drive may begin.
        numbers = np.arange(len(record.valid))
        begun = np.maximum.accumulate(np.where(record.valid, 0, numbers + 1))[windows.first]
        ahead = windows.first[:, None] + np.arange(-self._lead, windows.size)
        ahead = np.maximum(ahead, begun[:, None])
        # A held car begins its window at the measured state; a free one begins its lead there.
        begin = windows.first if held else ahead[:, 0]
        # Whole nanoseconds, so that points lie on the steps of the plant.
        time = [round(n * record.period, 9) for n in range(size)]
        smooth = {
            name: smoothed(record, name, cut_off) for name in SMOOTHED if name != LATERAL or held
        }
        speed = smooth[LONGITUDINAL][ahead]
        self._fixed: dict[str, list[Any]] = {
            "plant.speed": ["imposed" if self.is_imposed else "free"] * len(windows),
            "plant.imposed_speed.time": [time] * len(windows),
            "plant.imposed_speed.speed": speed.tolist(),
            "plant.initial_speed": (
                (
                    # With a free speed a held car keeps this one until its window begins.
                    speed[:, 0] if self.is_imposed or not held else speed[:, self._lead]
                ).tolist()
            ),
            # Without a measured lateral velocity there is none to be held at.
            "plant.initial_hold": [HOLD if held else 0.0] * len(windows),
            "plant.initial_lateral_velocity": (
                (smooth[LATERAL][begin] if held else np.zeros(len(begin))).tolist()
            ),
            "plant.initial_yaw_rate": smooth[YAW_RATE][begin].tolist(),
            "steering_column.time": [time] * len(windows),
            "steering_column.angle": self.road_wheel_angle[ahead].tolist(),
        }
        self.notes: tuple[str, ...] = ()
        if windows.at_rest:
            self.notes += (f"{windows.at_rest} windows in which the car stands are passed over",)
        if self.is_imposed:
            self.notes += (with_acceleration(record, smooth[LONGITUDINAL], cut_off),)
        # by driven wheel the torque [N m], (windows, size)
        self.driven_one_by_one: dict[str, np.ndarray] = {}
        if imposed == "pedals":
            self._fixed["driver.pedals.time"] = [time] * len(windows)
            for kind, channel in _PEDALS.items():
                # The sum over all wheels; the electronic differential of the replay shares it out.
                self._fixed[f"driver.pedals.{kind}_torque"] = self._torque(channel)[ahead].tolist()
        elif imposed == "torques":
            self._fixed["electronic_differential.time"] = [time] * len(windows)
            torques = self._wheel_torques()
            for name, torque in torques.items():
                self._fixed[f"electronic_differential.{name}"] = torque[ahead].tolist()
            driven = configurations["plant"].common.vehicle.driven_wheels
            self.driven_one_by_one = {
                wheel: windows.of(torques[f"drive.{wheel}"]) for wheel in driven
            }
        self._duration = time[-1]

    def scaled(self, channel: str, factor: float) -> OpenLoop:
        """The same with a measured channel, the speed or the steering angle, so much larger."""
        # The record itself stays: others replay it.
        channels = dict(self.record.channels)
        channels[channel] = factor * channels[channel]
        # The sideslip angle depends on the speed that was changed.
        if LATERAL in channels:
            speed = channels[LONGITUDINAL]
            known = np.isfinite(channels[SIDESLIP])
            channels[SIDESLIP] = np.where(known, sideslip(speed, channels[LATERAL], speed), np.nan)
        record = replace(self.record, channels=channels)
        return OpenLoop(
            record, self.windows, self.configurations, self._signals, self._imposed, self.cut_off
        )

    @property
    def steering_channel(self) -> str:
        """That of the measured angle: of the road wheels, or else of the steering wheel."""
        return (
            ROAD_WHEEL_ANGLE if ROAD_WHEEL_ANGLE in self.record.channels else STEERING_WHEEL_ANGLE
        )

    @property
    def road_wheel_angle(self) -> np.ndarray:
        """Measured angle, (n,) [rad], or that of the steering wheel over the car's ratio."""
        if ROAD_WHEEL_ANGLE in self.record.channels:
            return self.record[ROAD_WHEEL_ANGLE]
        ratio = self.configurations["plant"].common.vehicle.steering_ratio
        return self.record[STEERING_WHEEL_ANGLE] / ratio

    def _wheel_torques(self) -> dict[str, np.ndarray]:
        """Torques [N m] by KIND.WHEEL; none where the record has none, with a note."""
        channels = {
            f"{kind}.{wheel}": f"torque_command.{kind}.{wheel}"
            for kind in _PEDALS
            for wheel in WHEEL_NAMES
        }
        missing = [channel for channel in channels.values() if channel not in self.record.channels]
        if len(missing) == len(channels):
            raise ParameterError(
                f"{self.record.source} has no wheel torque, expected any of {', '.join(missing)}"
            )
        if missing:
            self.notes += (f"not in the record and taken as zero: {', '.join(missing)}",)
        none = np.zeros(len(self.record.valid))
        return {
            n: none if channel in missing else self._torque(channel)
            for n, channel in channels.items()
        }

    def _torque(self, channel: str) -> np.ndarray:
        """A channel [N m].

        A brake never drives, so what its sensor has below zero is none, of which a note is made.
        """
        # Below zero a brake would drive the car.
        torque = self.record[channel]
        low = float(torque.min())
        if ".brake" not in channel or low >= 0.0:
            return torque
        self.notes += (f"{channel} is below zero, down to {low:.4g} N m: taken as zero there",)
        return np.maximum(torque, 0.0)

    @property
    def compared(self) -> list[str]:
        """The signals of the record that are compared."""
        # What is imposed agrees by construction.
        given = (LONGITUDINAL, LONGITUDINAL_ACCELERATION) if self.is_imposed else ()
        return [name for name in COMPARED if name in self.record.channels and name not in given]

    def measured(self, signal: str) -> np.ndarray:
        """Windows of a signal of the record, (windows, size)."""
        return self.windows.of(self.record[signal])

    def simulate(self, cars: Sequence[Mapping[str, Any]] = ({},)) -> dict[str, np.ndarray]:
        """The signals of all windows for each car, (cars, windows, size).

        NaN where a number was not finite.

        A car is what is changed, by ROLE.PARAMETER or *.PARAMETER, the same names in all of them.
        """
        count = len(self.windows)
        # Windows change fastest, then cars: the shape below follows that order.
        vary = {name: values * len(cars) for name, values in self._fixed.items()}
        # All cars of a batch vary the same names.
        for name in cars[0]:
            if name in self._fixed:
                raise ParameterError(
                    f"{name} is refused: a replay has it from the record, expected is another one"
                )
            vary[name] = [car[name] for car in cars for _ in range(count)]
        found = batch(self.configurations, self._duration, vary, signals=self._signals).signals
        shaped = {
            n: values[:, self._lead :].reshape(len(cars), count, -1) for n, values in found.items()
        }
        return {
            **shaped,
            SIDESLIP: sideslip(shaped[LONGITUDINAL], shaped[LATERAL], self.measured(LONGITUDINAL)),
        }
