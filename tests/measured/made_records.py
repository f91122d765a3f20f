"""Records that are made by simulating a known car, written as somebody's logger would write them."""

from __future__ import annotations

import lzma
from functools import cache
from pathlib import Path

import numpy as np

from ev_sim.measured.replays.open_loop import graph
from ev_sim.recording.offline import run_offline
from ev_sim.recording.recording import Recording
from ev_sim.scenarios.scenario import Overrides

CAR = "compact_ev"
PERIOD = 0.01
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
  twist.lateral: {column: vy, unit: m/s, frame: sae, x: 1.0, y: 0.5}
  twist.yaw_rate: {column: r, unit: deg/s, frame: sae}
  imu.lateral_acceleration: {column: ay, unit: m/s2, frame: sae, x: 1.0, y: 0.5}
  steering_column.state.road_wheel_angle: {column: steer, unit: deg, sign: -1}
"""


@cache
def driven(duration: float = 12.0, seed: int = 0) -> Recording:
    """The car at 18 to 22 m/s, steered by three sines of up to 2 deg together: up to 5 m/s^2, far from any limit."""
    time = np.arange(round(duration / PERIOD) + 2) * PERIOD
    random = np.random.Generator(np.random.PCG64(seed))
    phases = random.uniform(0.0, 6.28, 3)
    angle = sum(np.radians(0.7) * np.sin(f * time + at) for f, at in zip((0.8, 2.1, 5.0), phases, strict=True))
    speed = 20.0 + 2.0 * np.sin(0.4 * time + phases[0])
    values = [
        ("plant", "initial_speed", float(speed[0])),
        ("plant", "initial_hold", 0.0),
        ("plant", "imposed_speed.time", time.tolist()),
        ("plant", "imposed_speed.speed", speed.tolist()),
        ("steering_column", "time", time.tolist()),
        ("steering_column", "angle", angle.tolist()),
    ]
    return run_offline(graph(CAR, PERIOD, Overrides(values=values)), duration)


def columns_of(recording: Recording, noise: float = 0.0, seed: int = 0) -> dict[str, np.ndarray]:
    """The columns that `MAPPING` describes: other units, SAE axes, a sensor beside the centre of mass.

    `noise` is that of the yaw rate [rad/s], a tenth of it that of the lateral velocity over 1 s [m/s].
    """
    random = np.random.Generator(np.random.PCG64(seed))
    of = {name: recording.channels[channel] for name, channel in CHANNELS.items() if channel != "time"}
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
    text = ",".join(columns) + "\n" + "\n".join(",".join(f"{x:.9g}" for x in row) for row in rows) + "\n"
    path.write_bytes(lzma.compress(text.encode()) if name.endswith(".xz") else text.encode())
    path.with_name("made.yaml").write_text(MAPPING)
    return path
