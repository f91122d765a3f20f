"""Records simulated with a known car, in the formats of other loggers."""

from __future__ import annotations

import lzma
from functools import cache
from pathlib import Path

import coverage_of_intervals
import numpy as np

from ev_stack.recording.recording import Recording

CAR, PERIOD = coverage_of_intervals.CAR, coverage_of_intervals.PERIOD
CHANNELS = {
    "t": "time",
    "speed": "twist.longitudinal",
    "vy": "twist.lateral",
    "r": "twist.yaw_rate",
    "ay": "imu.lateral_acceleration",
    "steer": "steering_column.state.road_wheel_angle",
}
MAPPING = """
time: {column: t, unit: ms}
channels:
  twist.longitudinal: {column: speed, unit: km/h, x: 1.0, y: 0.5}
  twist.lateral: {column: vy, unit: m/s, noise: 0.005, frame: sae, x: 1.0, y: 0.5}
  twist.yaw_rate: {column: r, unit: deg/s, frame: sae}
  imu.lateral_acceleration: {column: ay, unit: m/s2, frame: sae, x: 1.0, y: 0.5}
  steering_column.state.road_wheel_angle: {column: steer, unit: deg, sign: -1}
"""


@cache
def driven(duration: float = 12.0, seed: int = 0) -> Recording:
    """The car of the tool that counts held intervals, driven as there."""
    return coverage_of_intervals.driven(np.random.Generator(np.random.PCG64(seed)), duration)


def columns_of(recording: Recording, noise: float = 0.0, seed: int = 0) -> dict[str, np.ndarray]:
    """The columns that `MAPPING` describes.

    Other units, SAE axes, a sensor beside the centre of mass.

    `noise` is that of the yaw rate [rad/s], a tenth of it that of the lateral velocity over 1 s
    [m/s].
    """
    random = np.random.Generator(np.random.PCG64(seed))
    of = {
        name: recording.channels[channel] for name, channel in CHANNELS.items() if channel != "time"
    }
    rate = of["r"] + noise * random.standard_normal(len(of["r"]))
    lateral = of["vy"] + noise * random.standard_normal(len(rate))
    yaw = np.gradient(of["r"], PERIOD)
    return {
        "t": recording.time * 1e3,
        "speed": (of["speed"] - 0.5 * of["r"]) * 3.6,
        "vy": -(lateral + 1.0 * of["r"]),
        "r": -np.degrees(rate),
        "ay": -(of["ay"] + 1.0 * yaw - 0.5 * of["r"] ** 2),
        "steer": -np.degrees(of["steer"]),
    }


def write(folder: Path, columns: dict[str, np.ndarray], name: str = "made.csv") -> Path:
    """The record and its mapping beside it; packed if the name ends with .xz."""
    path = folder / name
    rows = np.stack(list(columns.values()), axis=1)
    text = (
        ",".join(columns)
        + "\n"
        + "\n".join(",".join(f"{x:.9g}" for x in row) for row in rows)
        + "\n"
    )
    path.write_bytes(lzma.compress(text.encode()) if name.endswith(".xz") else text.encode())
    path.with_name("made.yaml").write_text(MAPPING)
    return path
