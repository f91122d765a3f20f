"""What the plant `planar_electrical` shows of motors and cells, and a test bench of its energies."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.optional_signals import BenchEnergy
from ev_stack.measures.metric import Metric, channel, metric
from ev_stack.recording.recording import Recording

_CELL = "battery.cell"


def is_modelled(run: Recording) -> bool:
    """Whether the plant of the run knows the electrical side of its motors."""
    return f"{_CELL}.temperature" in run.channels


def electrical_metrics(run: Recording, vehicle: Vehicle) -> dict[str, Metric]:
    """Largest currents and temperatures, what was derated, and how far the cells were stressed; empty without model."""
    if not is_modelled(run):
        return {}

    def largest(quantity: str) -> float:
        return max(
            float(np.abs(channel(run, f"{quantity}.{wheel}")).max())
            for wheel in vehicle.driven_wheels
        )

    def derated() -> float:
        """Time in which winding or power stage of a driven wheel is above its warm temperature."""
        thermal, warm = vehicle.motor.thermal, np.zeros(len(run.time), bool)
        for wheel in vehicle.driven_wheels:
            warm |= channel(run, f"motor_temperatures.winding.{wheel}") > thermal.winding_warm
            warm |= channel(run, f"motor_temperatures.inverter.{wheel}") > thermal.inverter_warm
        return float((warm * np.diff(run.time, prepend=run.time[:1])).sum())

    of_motors: dict[str, tuple[Callable[[], float], str]] = {
        "peak_phase_current": (lambda: largest("motor_electrics.current"), "A"),
        "peak_phase_voltage": (lambda: largest("motor_electrics.voltage"), "V"),
        "peak_winding_temperature": (lambda: largest("motor_temperatures.winding"), "degC"),
        "peak_inverter_temperature": (lambda: largest("motor_temperatures.inverter"), "degC"),
        "derated_time": (derated, "s"),
        "least_cell_voltage": (lambda: float(channel(run, f"{_CELL}.voltage").min()), "V"),
        "largest_cell_voltage": (lambda: float(channel(run, f"{_CELL}.voltage").max()), "V"),
        "peak_cell_temperature": (
            lambda: float(channel(run, f"{_CELL}.temperature").max()),
            "degC",
        ),
    }
    return {
        name: metric(value, unit, name.replace("_", " "))
        for name, (value, unit) in of_motors.items()
    }


_GONE = ("resistor", "machines", "loads", "shafts", "stored")


def energies(run: Recording) -> dict[str, float]:
    """What each account of the bench holds at the end [J]; NotMeasured without a bench."""
    return {name: float(channel(run, f"bench.energy.{name}")[-1]) for name in BenchEnergy._fields}


def imbalance(run: Recording) -> float:
    """What is missing in battery + mains = resistor + heat + stored, over what was given [1]."""
    of = energies(run)
    given = of["battery"] + of["mains"]
    return (given - sum(of[name] for name in _GONE)) / max(abs(given), 1.0)
