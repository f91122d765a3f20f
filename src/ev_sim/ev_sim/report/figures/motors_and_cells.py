"""Currents, voltages, powers and temperatures of motors, inverters and cells."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ev_msgs_py.vehicle.description import Vehicle
from ev_sim.report.figures.figure import Figure
from ev_sim.report.figures.panels import Curve, panel
from ev_sim.report.figures.urban_sheets import both_sides, each_side, left_and_right, sheet_over_cycle
from ev_sim.report.samples import channel
from ev_sim.running.recording.recording import Recording

_COOLED = (("winding", "winding"), ("inverter", "power stage"), ("coolant_outlet", "coolant out"))


def motors_and_cells(run: Recording, vehicle: Vehicle, driver: Mapping[str, Any]) -> Figure:
    """Phase quantities of both sides, what warms up, and the mean cell, over a cycle."""

    def temperatures() -> list[Curve]:
        wheel = left_and_right(vehicle)[0]
        return [Curve(run.time, channel(run, f"motor_temperatures.{name}.{wheel}"), label) for name, label in _COOLED]

    return sheet_over_cycle(
        [
            *each_side(run, vehicle, "Phase current, rms", "current [A]", "motor_electrics.current"),
            *each_side(run, vehicle, "Phase voltage, rms", "voltage [V]", "motor_electrics.voltage"),
            *each_side(run, vehicle, "Power from the DC link", "power [W]", "motor_electrics.power"),
            panel("Winding", "temperature [degC]", lambda: both_sides(run, vehicle, "motor_temperatures.winding")),
            panel(f"Temperatures, {left_and_right(vehicle)[0].replace('_', ' ')}", "temperature [degC]", temperatures),
            panel("Cell", "voltage [V]", lambda: [Curve(run.time, channel(run, "battery.cell.voltage"))]),
            panel("Cell", "temperature [degC]", lambda: [Curve(run.time, channel(run, "battery.cell.temperature"))]),
        ],
        run,
        driver,
        columns=2,
    )
