"""Cars that the preview driver leads along a path, many speeds in one batch."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from ev_stack.batches.batch import BatchResult, batch
from ev_stack.scenarios.scenario import Overrides, load_scenario

PERIOD = 0.02  # [s] of the samples


def drives(
    car: str, speeds: Sequence[float], path: Mapping[str, Any], duration: float, vary: Mapping[str, Any] | None = None,
    **values: Any,
) -> BatchResult:  # fmt: skip
    """The car at each speed [m/s], which is held, or in reverse reached from rest.

    In `values` __ stands for a dot.
    """
    held = "held" if min(speeds) > 0.0 else "free"
    changed = {
        "driver.method": "preview",
        "plant.speed": held,
        "plant.initial_x": 0.0,
        "driver.plan.follow": False,
    }
    changed |= {f"driver.path.{name}": value for name, value in path.items()}
    changed |= {name.replace("__", "."): value for name, value in values.items()}
    words = [(*name.split(".", 1), value) for name, value in changed.items()]
    configurations = (
        load_scenario("double_lane_change", Overrides(values=words, vehicle=car))
        .runs[0]
        .configurations
    )
    by_speed = {
        "plant.initial_speed": [max(speed, 0.0) for speed in speeds],
        "driver.speed_profile.speed": [[speed] for speed in speeds],
    }
    signals = ("pose.x", "pose.y", "steering_column.state.angle", "driver.command.hand_torque")
    return batch(
        configurations, duration, vary={**by_speed, **(vary or {})}, signals=signals, every=2
    )


def from_circle(found: BatchResult, run: int, begin: float, radius: float) -> np.ndarray:
    """Distance [m], outwards negative, from a path straight to `begin` [m], then half a circle."""
    x, y = found.signals["pose.x"][run], found.signals["pose.y"][run]
    half = slice(0, np.flatnonzero(y > radius)[0] if (y > radius).any() else None)
    return np.where(x < begin, y, radius - np.hypot(x - begin, y - radius))[half]
