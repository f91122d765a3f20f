"""Figures 1.13 and 1.22: characteristics of machines."""

from __future__ import annotations

import math

import numpy as np

from ev_sim.drives.field_weakening import voltage_limited_torque
from ev_sim.drives.losses import loss_power
from ev_sim.report.figures.contours import contours
from ev_sim.report.figures.figure import Figure
from ev_sim.report.figures.panels import Curve, Panel, panel
from ev_sim.verdicts.need import ScenarioNeed, ScenarioRuns
from ev_sim.verdicts.panel import PublishedPanel, cannot_be_drawn, over_time

_ROW = "Characteristics of the YASA-400; limits as printed; losses, winding and voltages assumed"
_CAR = ScenarioNeed("urban_mixed", duration=0.01)  # for the car alone
_CELL = 3.2  # V
_SPEED = "speed of the shaft [rpm]"


def _speeds(driven: ScenarioRuns) -> np.ndarray:
    return np.linspace(10.0, driven.vehicle.motor.maximum_speed, 300)


def _limits(driven: ScenarioRuns) -> Panel:
    motor, speed, rpm = driven.vehicle.motor, _speeds(driven), _speeds(driven) * 30 / math.pi
    cells = driven.vehicle.battery.cells

    def curves() -> list[Curve]:
        drawn = []
        for share in (1.0, 0.75, 0.5):
            voltage = share * cells.in_series * _CELL
            envelope = np.array([voltage_limited_torque(motor.winding, voltage, each) for each in speed])
            torque = np.minimum(np.minimum(motor.peak_torque, motor.peak_power / speed), envelope)
            drawn += [
                Curve(rpm, torque, f"torque [N m], {voltage:.0f} V"),
                Curve(rpm, torque * speed / 1e3, f"power [kW], {voltage:.0f} V"),
            ]
        return drawn

    return panel("a  Peak torque and power by voltage, from assumed constants", "[N m], [kW]", curves)


def _efficiency(driven: ScenarioRuns) -> Figure:
    motor = driven.vehicle.motor
    speed, torque = np.meshgrid(_speeds(driven), np.linspace(5.0, motor.peak_torque, 100))
    power = speed * torque
    efficiency = np.where(power <= motor.peak_power, power / (power + loss_power(motor, torque, speed)), np.nan)
    levels = (0.5, 0.7, 0.8, 0.85, 0.9, 0.92, 0.94, 0.95, 0.96)
    return contours(
        "b  Efficiency of motor and inverter, as assumed",
        (_SPEED, speed * 30 / math.pi),
        ("torque [N m]", torque),
        efficiency,
        levels,
    )


PANELS = (
    cannot_be_drawn(
        "1.13", "", "Double planetary drive of another maker", "only the caption of its curve is left", "diss.fig1.13"
    ),
    PublishedPanel("1.22", "a", _ROW, ("diss.fig1.22",), (_CAR,), over_time(_limits, _SPEED)),
    PublishedPanel("1.22", "b", _ROW, ("diss.fig1.22",), (_CAR,), _efficiency),
)
