"""Motors and cells of the plant with its electrical side, and the energies of a test bench."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ev_core.vehicle.description import Vehicle
from ev_msgs_py.contract.optional_signals import BenchEnergy
from ev_stack.measures.metric import Metric, channel, metric
from ev_stack.recording.recording import Recording

_CELL = "battery.cell"
_SPENT = ("resistor", "machines", "loads", "shafts", "stored")  # accounts of what was given


def is_modelled(run: Recording) -> bool:
    """True if the plant of the run has the electrical side of its motors."""
    return f"{_CELL}.temperature" in run.channels


def electrical_metrics(run: Recording, vehicle: Vehicle) -> dict[str, Metric]:
    """Largest currents and temperatures, derated time, stress of the cells; empty without model."""
    if not is_modelled(run):
        return {}

    def largest(quantity: str) -> float:
        return max(
            float(np.abs(channel(run, f"{quantity}.{wheel}")).max())
            for wheel in vehicle.driven_wheels
        )

    def derated() -> float:
        """Time in which winding or power stage of a driven wheel is above its warm temperature."""
        thermal = vehicle.motor.thermal
        warm = np.zeros(len(run.time), bool)
        for wheel in vehicle.driven_wheels:
            warm |= channel(run, f"motor_temperatures.winding.{wheel}") > thermal.winding_warm
            warm |= channel(run, f"motor_temperatures.inverter.{wheel}") > thermal.inverter_warm
        return float((warm * np.diff(run.time, prepend=run.time[:1])).sum())

    def of_cell(quantity: str) -> np.ndarray:
        return channel(run, f"{_CELL}.{quantity}")

    of_motors: dict[str, tuple[Callable[[], float], str]] = {
        "peak_phase_current": (lambda: largest("motor_electrics.current"), "A"),
        "peak_phase_voltage": (lambda: largest("motor_electrics.voltage"), "V"),
        "peak_winding_temperature": (lambda: largest("motor_temperatures.winding"), "degC"),
        "peak_inverter_temperature": (lambda: largest("motor_temperatures.inverter"), "degC"),
        "derated_time": (derated, "s"),
        "least_cell_voltage": (lambda: of_cell("voltage").min(), "V"),
        "largest_cell_voltage": (lambda: of_cell("voltage").max(), "V"),
        "peak_cell_temperature": (lambda: of_cell("temperature").max(), "degC"),
    }
    return {
        name: metric(value, unit, name.replace("_", " "))
        for name, (value, unit) in of_motors.items()
    }


def energies(run: Recording) -> dict[str, float]:
    """Content of each account of the bench at the end [J]; NotMeasured without a bench."""
    return {name: float(channel(run, f"bench.energy.{name}")[-1]) for name in BenchEnergy._fields}


def imbalance(run: Recording) -> float:
    """Gap in battery + mains = resistor + heat + stored, over what was given [1]."""
    of = energies(run)
    given = of["battery"] + of["mains"]
    missing = given - sum(of[name] for name in _SPENT)
    return missing / max(abs(given), 1.0)
