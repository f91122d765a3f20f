"""Records of measured signals: a CSV file and the mapping that says what its columns are."""

from __future__ import annotations

import hashlib
import lzma
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import yaml

from ev_core.parameters.data_file import MEGABYTE, SIGNALS, TEXT, read_data
from ev_core.parameters.declaration import parameter, setting
from ev_core.parameters.values import build
from ev_msgs_py.contract import frame
from ev_msgs_py.refusal import ParameterError, quoted, unknown_name
from ev_sim.scenarios.parameter_file import read_yaml

YAW_RATE, LATERAL, LONGITUDINAL = "twist.yaw_rate", "twist.lateral", "twist.longitudinal"
LATERAL_ACCELERATION, LONGITUDINAL_ACCELERATION = "imu.lateral_acceleration", "imu.longitudinal_acceleration"
ROAD_WHEEL_ANGLE, STEERING_WHEEL_ANGLE = "steering_column.state.road_wheel_angle", "steering_column.state.angle"
SIDESLIP = "sideslip"  # [rad], which no topic has: atan2 of lateral over longitudinal velocity

UNITS = {
    **{"1": 1.0, "s": 1.0, "ms": 1e-3, "us": 1e-6, "m": 1.0, "m/s": 1.0, "km/h": 1 / 3.6, "mph": 0.44704},
    **{"rad": 1.0, "deg": np.pi / 180, "rad/s": 1.0, "deg/s": np.pi / 180, "rpm": np.pi / 30},
    **{"m/s2": 1.0, "g": 9.80665, "N": 1.0, "kN": 1e3, "N m": 1.0, "degC": 1.0, "kPa": 1e3, "cm": 1e-2, "W": 1.0},
}
_LONGEST_SPIKE = 10  # instants in which a signal that has jumped away has to be back, else it has jumped for good
_FLIPPED = (YAW_RATE, "imu.yaw_rate", LATERAL, LATERAL_ACCELERATION, ROAD_WHEEL_ANGLE, STEERING_WHEEL_ANGLE, SIDESLIP)


@dataclass(frozen=True, slots=True)
class ColumnParameters:
    """What a column of a record is."""

    column: str = setting("", about="its name in the header of the file")
    unit: str = setting("1", choices=tuple(UNITS), about="of the numbers of the column")
    sign: float = setting(
        1.0, unit="1", low=-1.0, high=1.0, about="-1 for a sensor that is mounted the other way round"
    )
    frame: str = setting(
        "iso", choices=("iso", "sae"), about="axes; iso: y to the left, z up (REP-103); sae: y to the right, z down"
    )
    x: float = setting(0.0, unit="m", low=-20.0, high=20.0, about="of the sensor, ahead of the centre of mass")
    y: float = setting(0.0, unit="m", low=-5.0, high=5.0, about="of the sensor, left of the centre of mass")


@dataclass(frozen=True, slots=True)
class MaskParameters:
    """Where a record is not believed."""

    steering_rate: float = parameter(
        3.0,
        unit="rad/s",
        low=0.01,
        high=100.0,
        about="of the road wheels, of the steering wheel 16 times as much; a faster change is a jump",
    )
    bridge: float = parameter(
        0.05, unit="s", low=0.0, high=1.0, about="of jumps and gaps up to this length the inputs are interpolated"
    )


@dataclass(frozen=True)
class MeasuredRecord:
    """Signals over equally spaced instants from time zero on, at the centre of mass, in SI and REP-103.

    `channels` have the names of signals.npz and `SIDESLIP`, (n,) each. `valid` (n,) marks the instants that are
    believed; elsewhere channels hold interpolated numbers. `begin` [s] is the time of the file at the first instant.
    """

    source: str
    digest: str
    begin: float
    period: float
    channels: Mapping[str, np.ndarray]
    valid: np.ndarray
    notes: tuple[str, ...] = ()

    @property
    def time(self) -> np.ndarray:
        """The instants in the time of the file [s]."""
        return self.begin + self.period * np.arange(len(self.valid))

    def __getitem__(self, channel: str) -> np.ndarray:
        """A channel; ParameterError if the record does not have it."""
        if channel not in self.channels:
            raise unknown_name(f"channel of {self.source}", channel, self.channels)
        return self.channels[channel]


def read_columns(path: Path) -> tuple[dict[str, np.ndarray], str]:
    """The columns of a CSV file, by name, and its SHA-256; .csv.xz is unpacked. ParameterError, in one line, if not."""
    try:
        content = read_data(path, SIGNALS)
        text = lzma.LZMADecompressor().decompress(content, SIGNALS) if path.suffix == ".xz" else content
        header, *lines = text.decode("utf-8-sig").splitlines() or [""]
        names = [cell.strip() for cell in header.split(",")]
        rows = np.genfromtxt(lines, delimiter=",", ndmin=2) if any(map(str.strip, lines)) else np.empty((0, len(names)))
    except OSError as error:
        raise ParameterError(f"{path}: {error.strerror or error}") from None
    except (lzma.LZMAError, ValueError, UnicodeDecodeError) as error:
        reason = " ".join(str(error).split())[:200]
        raise ParameterError(f"{path} is no CSV table of at most {SIGNALS // MEGABYTE} MB: {reason}") from None
    if rows.shape[1] != len(names) or len(set(names)) < len(names):
        raise ParameterError(f"{path}: the header names {len(names)} columns, the rows have {rows.shape[1]}")
    return dict(zip(names, rows.T, strict=True)), hashlib.sha256(content).hexdigest()


def read_record(path: Path, mapping: Path) -> MeasuredRecord:
    """The record of a CSV file, by its mapping; ParameterError, in one line that names the file, if it is refused."""
    try:
        given = read_yaml(read_data(mapping, TEXT).decode())
    except OSError as error:
        raise ParameterError(f"{mapping}: {error.strerror or error}") from None
    except (yaml.YAMLError, UnicodeDecodeError):
        raise ParameterError(f"{mapping} is no YAML text") from None
    if not isinstance(given, dict) or not isinstance(given.get("channels"), dict) or "time" not in given:
        raise ParameterError(f"{mapping}: allowed is a mapping with time, channels and, if wanted, mask")
    for name in given:
        if name not in ("time", "channels", "mask"):
            raise ParameterError(f"{mapping}: {unknown_name('entry', name, ('time', 'channels', 'mask'))}")
    known = (*frame.channels(), SIDESLIP)
    columns, digest = read_columns(path)
    time = _column(mapping, path, "time", given["time"], columns)[0]
    found: dict[str, tuple[np.ndarray, ColumnParameters]] = {}
    for name, about in given["channels"].items():
        if name not in known:
            raise ParameterError(f"{mapping}: {unknown_name('channel', name, known)}")
        found[name] = _column(mapping, path, name, about, columns)
    return measured(str(path), digest, time, found, build(MaskParameters, given.get("mask") or {}))


def _column(
    mapping: Path, path: Path, name: str, about: Any, columns: Mapping[str, np.ndarray]
) -> tuple[np.ndarray, ColumnParameters]:
    """A column in SI and REP-103, and its declaration."""
    try:
        declared = build(ColumnParameters, {"column": about} if isinstance(about, str) else about)
        if declared.column not in columns:
            raise unknown_name(f"column of {path}", declared.column, columns)
    except (ParameterError, AttributeError, TypeError) as error:
        raise ParameterError(f"{mapping}: {name}: {error}") from None
    turned = -1.0 if declared.frame == "sae" and name in _FLIPPED else 1.0
    return columns[declared.column] * (UNITS[declared.unit] * turned * declared.sign), declared


def measured(
    source: str,
    digest: str,
    time: np.ndarray,
    columns: Mapping[str, tuple[np.ndarray, ColumnParameters]],
    mask: MaskParameters,
) -> MeasuredRecord:
    """The record of columns over a time [s], (n,) each, in SI and REP-103 at the places of their sensors."""
    if len(time) < 2 or not np.isfinite(time).all() or (np.diff(time) <= 0.0).any():
        raise ParameterError(f"{source}: its time does not increase, or there are less than two instants")
    period = round(float(np.median(np.diff(time))), 6)
    instants = np.arange(int((time[-1] - time[0]) / period + 1.5)) * period
    before = np.clip(np.searchsorted(time - time[0], instants + 1e-9, side="right") - 1, 0, len(time) - 2)
    valid = (time[before + 1] - time[before] < 1.5 * period) | (np.abs(time[before] - time[0] - instants) < 1e-6)
    channels = {}
    for name, (values, _) in columns.items():
        finite = np.isfinite(values)
        if finite.sum() < 2:
            raise ParameterError(f"{source}: {name} has less than two finite numbers")
        channels[name] = np.interp(instants, time[finite] - time[0], values[finite])
        valid &= np.interp(instants, time - time[0], finite) == 1.0
    _move_to_centre(channels, {name: declared for name, (_, declared) in columns.items()}, period)
    for name in (ROAD_WHEEL_ANGLE, STEERING_WHEEL_ANGLE):
        if name in channels:
            limit = mask.steering_rate * (16.0 if name == STEERING_WHEEL_ANGLE else 1.0)
            valid &= ~_jumps(channels[name], limit * period)
    notes = _bridge(channels, valid, max(int(mask.bridge / period + 0.5), 0))
    if SIDESLIP not in channels and {LATERAL, LONGITUDINAL} <= channels.keys():
        channels[SIDESLIP] = np.arctan2(channels[LATERAL], channels[LONGITUDINAL])
    return MeasuredRecord(source, digest, float(time[0]), period, channels, valid, notes)


def _move_to_centre(channels: dict[str, np.ndarray], declared: Mapping[str, ColumnParameters], period: float) -> None:
    """Velocities and accelerations of sensors beside the centre of mass, of a rigid body that turns in the plane."""
    moved = [n for n, of in declared.items() if of.x or of.y]
    if not moved:
        return
    if YAW_RATE not in channels:
        raise ParameterError(f"{moved[0]} was measured beside the centre of mass, which needs {YAW_RATE}")
    yaw_rate = channels[YAW_RATE]
    yaw = np.gradient(yaw_rate, period)
    for name in moved:
        x, y = declared[name].x, declared[name].y
        channels[name] = channels[name] + {
            LONGITUDINAL: y * yaw_rate,
            LATERAL: -x * yaw_rate,
            LONGITUDINAL_ACCELERATION: x * yaw_rate**2 + y * yaw,
            LATERAL_ACCELERATION: -x * yaw + y * yaw_rate**2,
        }.get(name, 0.0)


def _jumps(values: np.ndarray, limit: float) -> np.ndarray:
    """Where a series jumps away, up to where it is back; a jump that does not come back is one instant."""
    jumped = np.zeros(len(values), bool)
    behind = 0
    for edge in np.flatnonzero(np.abs(np.diff(values)) > limit):
        if edge < behind:
            continue
        after = values[edge + 1 : edge + 2 + _LONGEST_SPIKE]
        back = np.flatnonzero(np.abs(after - values[edge]) < 3.0 * limit)
        behind = edge + 1 + (int(back[0]) if len(back) else 1)
        jumped[edge + 1 : behind] = True
    return jumped


def _bridge(channels: dict[str, np.ndarray], valid: np.ndarray, most: int) -> tuple[str, ...]:
    """Interpolate all channels where they are not believed; what is short is believed then."""
    bad = np.flatnonzero(~valid)
    if not len(bad):
        return ()
    good = np.flatnonzero(valid)
    if len(good) < 2:
        raise ParameterError("the record has less than two instants that are believed")
    for name, values in channels.items():
        channels[name] = values.copy()
        channels[name][bad] = np.interp(bad, good, values[good])
    runs = np.split(bad, np.flatnonzero(np.diff(bad) > 1) + 1)
    for run in runs:
        valid[run] = len(run) <= most
    long = sum(len(run) > most for run in runs)
    return (f"{len(bad)} instants in {len(runs)} jumps and gaps, {len(runs) - long} of them bridged, {long} masked",)


def quoted_source(record: MeasuredRecord) -> str:
    """The name of the file and the beginning of its hash."""
    return f"{Path(record.source).name}, SHA-256 {record.digest[:12]}" if record.digest else quoted(record.source)
