"""The panels of the dissertation's figures."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from ev_papers.dissertation.figures.over_cycle import (
    CYCLES,
    ON_BENCH,
    drive_efficiency,
    driver_of,
    of_each_method,
    over_friction,
    recorded,
    run_of,
    speeds,
    torques,
    wheel_efficiency,
)
from ev_papers.dissertation.figures.slip_curve import slip_curve_figure
from ev_papers.dissertation.figures.urban_cycle import cycle_figure
from ev_papers.dissertation.figures.urban_sheets import sheet_over_cycle
from ev_sim.drives.field_weakening import voltage_limited_torque
from ev_sim.drives.losses import loss_power
from ev_sim.figures.figure import Figure
from ev_sim.figures.over_values import contours
from ev_sim.figures.panels import Curve, Panel, panel
from ev_sim.measures.samples import channel
from ev_sim.profiles.profile import SpeedProfileParameters, with_profile_from_file
from ev_sim.verdicts.need import ScenarioNeed, ScenarioRuns
from ev_sim.verdicts.panels_page import PublishedPanel, cannot_be_drawn, over_time

_FIGURES_OF_A_METHOD = 5
_TORQUES = recorded("Torques at the transducers", "torque [N m]", "bench.shafts.torque")
_SPEEDS = recorded("Speeds at the transducers", "speed [rad/s]", "bench.shafts.speed")
_CURRENTS = recorded("Currents of the machines under test", "current [A]", "bench.electrical.current")
_VOLTAGES = recorded("Voltages of the machines under test", "voltage [V]", "bench.electrical.voltage")


def _figure(place: int) -> Callable[[int], str]:
    return lambda method: f"5.{_FIGURES_OF_A_METHOD * (method - 1) + place}"


def _model_and_bench(model: ScenarioRuns, bench: ScenarioRuns) -> Figure:
    """Right torque of both runs of method 1."""

    def curves() -> list[Curve]:
        one, other = run_of(model), run_of(bench)
        return [
            Curve(one.time, channel(one, "motor_states.effort.front_right"), "model"),
            Curve(other.time, channel(other, "bench.shafts.torque.front_right"), "bench"),
        ]

    shown = panel("Right torque, method 1", "torque [N m]", curves)
    return sheet_over_cycle([shown], run_of(model), driver_of(model))


_BENCH_PANELS = (
    *of_each_method("Bench, torques, methods 1 to 5", _figure(1), "", _TORQUES, ON_BENCH),
    *of_each_method("Bench, speeds, methods 1 to 5", _figure(2), "", _SPEEDS, ON_BENCH),
    *of_each_method("Bench, currents, methods 1 to 5", _figure(3), "", _CURRENTS, ON_BENCH),
    *of_each_method("Bench, voltages, methods 1 to 5", _figure(4), "", _VOLTAGES, ON_BENCH),
    *of_each_method("Bench, drive efficiency, right", _figure(5), "a", drive_efficiency("right"), ON_BENCH),
    *of_each_method("Bench, drive efficiency, left", _figure(5), "b", drive_efficiency("left"), ON_BENCH),
    *of_each_method("Bench, torques and friction", _figure(5), "v", over_friction(_TORQUES), ON_BENCH),
    PublishedPanel("5.26", "", "Model against bench", ("diss.fig5.26",), (CYCLES[1], ON_BENCH[1]), _model_and_bench),
)


_CYCLES = "Speed over time of urban cycles"
_NO_DATA = "the source draws it from a catalogue, no data are in the text"


def _slip_curve(driven: ScenarioRuns) -> Figure:
    return slip_curve_figure(run_of(driven), driven.vehicle)


def _road(driven: ScenarioRuns) -> Figure:
    return cycle_figure(run_of(driven), driven.vehicle, driver_of(driven))


def _cycle(title: str, file: str) -> Callable[[], Panel]:
    def points() -> list[Curve]:
        cycle = with_profile_from_file(SpeedProfileParameters(file=file))
        return [Curve(np.array(cycle.time), 3.6 * np.array(cycle.speed))]

    return lambda: panel(title, "speed [km/h]", points)


_CYCLE_PANELS = (
    PublishedPanel("2.8", "", "Fit of the slip curve", ("diss.fig2.8",), (CYCLES[1],), _slip_curve),
    cannot_be_drawn("2.9", "", _CYCLES, f"European Transient Cycle: {_NO_DATA}", "diss.fig2.9"),
    PublishedPanel(
        "2.10",
        "",
        _CYCLES,
        ("diss.fig2.10",),
        draw=over_time(_cycle("EPA New York City Cycle, the public data", "cycles/nycc.csv")),
    ),
    cannot_be_drawn("2.11", "", _CYCLES, f"modemIM Urban_Slow: {_NO_DATA}", "diss.fig2.11"),
    PublishedPanel(
        "2.12", "", _CYCLES, ("diss.fig2.12",), draw=over_time(_cycle("TRRL 1.1, table 2.4", "cycles/trrl_1_1.csv"))
    ),
    PublishedPanel("2.13", "", "Cycle and road", ("diss.fig2.13",), (CYCLES[1],), _road),
)


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


_MACHINE_PANELS = (
    cannot_be_drawn(
        "1.13", "", "Double planetary drive of another maker", "only the caption of its curve is left", "diss.fig1.13"
    ),
    PublishedPanel("1.22", "a", _ROW, ("diss.fig1.22",), (_CAR,), over_time(_limits, _SPEED)),
    PublishedPanel("1.22", "b", _ROW, ("diss.fig1.22",), (_CAR,), _efficiency),
)


_ROWS = {
    "1": ("Block diagrams of the surveyed slip controls", range(14, 21)),
    "2": ("Schemes of car, wheel, body and control, screens of the model", (*range(1, 8), *range(14, 22))),
    "4": ("The test bench", range(1, 12)),
}
_WHY = "a scheme, a photograph or a screen, no quantity over another one"


def _scheme(row: str, figure: str) -> PublishedPanel:
    return cannot_be_drawn(figure, "", row, _WHY, f"diss.fig{figure}")


_SCHEMES_PANELS = tuple(
    _scheme(row, f"{chapter}.{number}") for chapter, (row, numbers) in _ROWS.items() for number in numbers
)


def _signals(method: int) -> str:
    return f"3.{2 * method - 1}"


def _efficiencies(method: int) -> str:
    return f"3.{2 * method}"


_SIMULATION_PANELS = (
    *of_each_method("Simulation, torques at the shafts, methods 1 to 5", _signals, "a", torques),
    *of_each_method("Simulation, speeds of the shafts, methods 1 to 5", _signals, "b", speeds),
    *of_each_method("Simulation, wheel efficiency, right", _efficiencies, "a", wheel_efficiency("right")),
    *of_each_method("Simulation, wheel efficiency, left", _efficiencies, "b", wheel_efficiency("left")),
    *of_each_method("Simulation, torques beside the efficiencies", _efficiencies, "v", torques),
)


PANELS = (*_MACHINE_PANELS, *_CYCLE_PANELS, *_SIMULATION_PANELS, *_BENCH_PANELS, *_SCHEMES_PANELS)
