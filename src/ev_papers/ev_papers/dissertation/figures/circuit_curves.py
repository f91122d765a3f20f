"""Curves of one circuit (driven wheel, motor, inverter) over a cycle, before they are drawn."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ev_core.vehicle.description import Vehicle
from ev_papers.dissertation.measures import circuits
from ev_papers.dissertation.measures import traction_windows as cycle
from ev_sim.figures.panels import Curve
from ev_sim.measures.metric import NotMeasured
from ev_sim.measures.samples import channel
from ev_sim.recording.recording import Recording


def running_wheel_efficiency(
    run: Recording, vehicle: Vehicle, driver: Mapping[str, Any], wheel: str, label: str = ""
) -> Curve:
    """Eq 2.37 from the start of the cycle up to each sample; a gap where fractions of a turn give nonsense."""
    found = _shares(run, vehicle, wheel).running_efficiency(cycle.traction(run, driver))
    return Curve(run.time, np.where((found >= 0.0) & (found <= 1.0), found, np.nan), label)


def running_drive_efficiency(
    run: Recording, vehicle: Vehicle, driver: Mapping[str, Any], wheel: str, label: str = ""
) -> Curve:
    """Eq 2.38 from the start of the cycle up to each sample."""
    found = _shares(run, vehicle, wheel).running_drive_efficiency(cycle.traction(run, driver))
    return Curve(run.time, np.where(found >= 0.0, found, np.nan), label)


def circuit_current(run: Recording, vehicle: Vehicle, wheel: str, label: str = "") -> Curve:
    """What the circuit takes from the battery [A]."""
    period = np.diff(run.time, prepend=run.time[0] - 1.0)  # the first sample has no period before it
    work = _shares(run, vehicle, wheel).electrical_work
    return Curve(run.time, work / period / channel(run, "battery.voltage"), label)


def _shares(run: Recording, vehicle: Vehicle, wheel: str) -> circuits.CircuitShares:
    shares = circuits.circuit_shares(run, vehicle)
    if wheel not in shares:
        raise NotMeasured(f"{wheel.replace('_', ' ')} is not driven")
    return shares[wheel]
