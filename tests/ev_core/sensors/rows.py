"""Sensors in frames, without a graph."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from ev_core.sensors.row import QUANTITIES, Quantity, SensorRow, sensors_for
from ev_msgs_py.contract import frame

EVERYTHING = {"noise": 0.01, "bias": -0.01, "quantisation": 1e-3, "delay": 2, "dropout": 0.1}


def quantity_named(name: str) -> Quantity:
    return next(quantity for quantity in QUANTITIES if quantity.name == name)


def sensors(errors: Mapping[str, Mapping[str, float]]) -> Any:
    """Parameters of sensors: what differs from the ideal, by quantity."""
    ideal = sensors_for(tuple({quantity_named(name).signal for name in errors}))()
    return replace(
        ideal, **{name: replace(getattr(ideal, name), **given) for name, given in errors.items()}
    )


def shown(
    true: np.ndarray, seed: int = 0, name: str = "imu_yaw_rate", **errors: float
) -> np.ndarray:
    """Show rows of numbers by the sensor of a quantity; single numbers if they are (n,)."""
    places = list(quantity_named(name).places)[: 1 if true.ndim == 1 else None]
    row = SensorRow(sensors({name: errors}), seed)
    got = np.empty_like(true)
    for n, values in enumerate(true.reshape(len(true), -1)):
        numbers = np.zeros(frame.SIZE)
        numbers[places] = values
        row.step(as_list := numbers.tolist())
        got[n] = np.array(as_list)[places].reshape(true.shape[1:])
    return got
