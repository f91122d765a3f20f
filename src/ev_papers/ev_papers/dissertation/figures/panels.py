"""The panels of the dissertation's figures."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from ev_core.vehicle.description import Vehicle
from ev_core.vehicle.losses import loss_power
from ev_papers.dissertation.figures.slip_curve import slip_curve_figure
from ev_papers.dissertation.figures.urban_mixed import (
    OF_A_CIRCUIT,
    electrical,
    over_friction,
    wheel_efficiency,
)
from ev_papers.dissertation.figures.urban_sheets import cycle_figure, over_cycle
from ev_papers.dissertation.measures.urban_cases import BENCH, FIVE, METHODS, SCENARIO, case
from ev_sim.drives.synchronous_motor import voltage_limited_torque
from ev_sim.profiles.profile import SpeedProfileParameters, with_profile_from_file
from ev_stack.figures.other_axes import contours
from ev_stack.figures.panels import Curve, Panel, panel
from ev_stack.figures.sheets import Sheet
from ev_stack.measures.metric import channel
from ev_stack.recording.recording import Recording
from ev_study.verdicts.need import ScenarioNeed, ScenarioRuns
from ev_study.verdicts.panels_page import Draw, PublishedPanel, cannot_be_drawn, over_time

# Draws a run, given its car and the parameters of its driver.
_OfRun = Callable[[Recording, Vehicle, Mapping[str, Any]], Sheet]
_FIGURES_OF_A_METHOD = 5
_CYCLES = "Speed over time of urban cycles"
_NO_DATA = "the source draws it from a catalogue, no data are in the text"
_ROW = "Characteristics of the YASA-400; limits as printed; losses, winding and voltages assumed"
_CAR = ScenarioNeed("urban_mixed", duration=0.01)  # for the car alone
_CELL = 3.2  # V
_SPEED = "shaft speed [rad/s]"
_ROWS = {
    "1": (
        "Layouts, differentials, surveyed slip controls, machine",
        (*range(1, 5), *range(6, 13), *range(14, 22)),
    ),
    "2": (
        "Schemes of car, wheel, body and control, screens of the model",
        (*range(1, 8), *range(14, 22)),
    ),
    "4": ("The test bench", range(1, 12)),
}
_WHY = "a scheme, a photograph or a screen, no quantity over another one"


def _needs(scenario: str) -> dict[int, ScenarioNeed]:
    """Cycle of each method with driver pulse on the first road, by the number of the method."""
    found = {}
    for name in FIVE:
        values = case(name, "pulse", 1).values
        found[METHODS[name].number] = ScenarioNeed(scenario, values, slow=True)
    return found


CYCLES = _needs(SCENARIO)
ON_BENCH = _needs(BENCH)


def _of_run(draw: _OfRun) -> Draw:
    """Function that draws the only run of a scenario."""

    def drawn(driven: ScenarioRuns) -> Sheet:
        (run,) = driven.runs.values()
        return draw(run, driven.vehicle, driven.parameters["driver"])

    return drawn


def _of_each_method(
    row: str,
    figure: Callable[[int], str],
    letter: str,
    draw: _OfRun,
    cycles: Mapping[int, ScenarioNeed],
) -> tuple[PublishedPanel, ...]:
    """The same panel for methods 1 to 5; `figure` gives the number of the figure of a method."""
    ending = f".{letter}" if letter else ""
    found = []
    for number, need in cycles.items():
        name = figure(number)
        ids = (f"diss.fig{name}{ending}",)
        found.append(PublishedPanel(name, letter, row, ids, (need,), _of_run(draw)))
    return tuple(found)


def _quantity(name: str, side: str = "") -> _OfRun:
    return lambda run, vehicle, driver: electrical(run, vehicle, driver, (name,), side)


def _efficiency_of_wheel(side: str) -> _OfRun:
    return lambda run, vehicle, driver: wheel_efficiency(run, vehicle, driver, (f"front_{side}",))


def _on_bench(row: str, place: int, letter: str, draw: _OfRun) -> tuple[PublishedPanel, ...]:
    return _of_each_method(
        f"Bench, {row}",
        lambda method: f"5.{_FIGURES_OF_A_METHOD * (method - 1) + place}",
        letter,
        draw,
        ON_BENCH,
    )


def _simulated(row: str, first: int, letter: str, draw: _OfRun) -> tuple[PublishedPanel, ...]:
    return _of_each_method(
        f"Simulation, {row}", lambda method: f"3.{2 * method - 2 + first}", letter, draw, CYCLES
    )


def _model_and_bench(model: ScenarioRuns, bench: ScenarioRuns) -> Sheet:
    """Right torque of both runs of method 1."""
    (one,) = model.runs.values()
    (other,) = bench.runs.values()

    def curves() -> list[Curve]:
        return [
            Curve(one.time, channel(one, "motor_states.effort.front_right"), "model"),
            Curve(other.time, channel(other, "bench.shafts.torque.front_right"), "bench"),
        ]

    torque = panel("Right torque, method 1", "torque [N m]", curves)
    return over_cycle([torque], one, model.parameters["driver"])


_BENCH_PANELS = (
    *(
        each
        for place, name in enumerate(OF_A_CIRCUIT[:-1], start=1)
        for each in _on_bench(f"{name}s, methods 1 to 5", place, "", _quantity(name))
    ),
    *_on_bench("drive efficiency, right", 5, "a", _quantity("drive efficiency", "right")),
    *_on_bench("drive efficiency, left", 5, "b", _quantity("drive efficiency", "left")),
    *_on_bench("torques and friction", 5, "v", over_friction),
    PublishedPanel(
        "5.26",
        "",
        "Model against bench",
        ("diss.fig5.26",),
        (CYCLES[1], ON_BENCH[1]),
        _model_and_bench,
    ),
)


_slip_curve = _of_run(lambda run, vehicle, driver: slip_curve_figure(run, vehicle))


def _cycle(figure: str, title: str, file: str) -> PublishedPanel:
    def points() -> list[Curve]:
        cycle = with_profile_from_file(SpeedProfileParameters(file=file))
        return [Curve(np.array(cycle.time), np.array(cycle.speed))]

    draw = over_time(lambda: panel(title, "speed [m/s]", points))
    return PublishedPanel(figure, "", _CYCLES, (f"diss.fig{figure}",), draw=draw)


_CYCLE_PANELS = (
    PublishedPanel("2.8", "", "Fit of the slip curve", ("diss.fig2.8",), (CYCLES[1],), _slip_curve),
    cannot_be_drawn("2.9", "", _CYCLES, f"European Transient Cycle: {_NO_DATA}", "diss.fig2.9"),
    _cycle("2.10", "EPA New York City Cycle, the public data", "cycles/nycc.csv"),
    cannot_be_drawn("2.11", "", _CYCLES, f"modemIM Urban_Slow: {_NO_DATA}", "diss.fig2.11"),
    _cycle("2.12", "TRRL 1.1, table 2.4", "cycles/trrl_1_1.csv"),
    PublishedPanel(
        "2.13", "", "Cycle and road", ("diss.fig2.13",), (CYCLES[1],), _of_run(cycle_figure)
    ),
)


def _speeds(driven: ScenarioRuns) -> np.ndarray:
    return np.linspace(10.0, driven.vehicle.motor.maximum_speed, 300)


def _limits(driven: ScenarioRuns) -> Panel:
    motor, speed = driven.vehicle.motor, _speeds(driven)
    cells = driven.vehicle.battery.cells

    def curves() -> list[Curve]:
        drawn = []
        for share in (1.0, 0.75, 0.5):
            voltage = share * cells.in_series * _CELL
            envelope = np.array(
                [voltage_limited_torque(motor.winding, voltage, each) for each in speed]
            )
            torque = np.minimum(np.minimum(motor.peak_torque, motor.peak_power / speed), envelope)
            drawn += [
                Curve(speed, torque, f"torque [N m], {voltage:.0f} V"),
                Curve(speed, torque * speed / 1e3, f"power [kW], {voltage:.0f} V"),
            ]
        return drawn

    return panel(
        "a  Peak torque and power by voltage, from assumed constants",
        "torque [N m], power [kW]",
        curves,
    )


def _efficiency(driven: ScenarioRuns) -> Sheet:
    motor = driven.vehicle.motor
    speed, torque = np.meshgrid(_speeds(driven), np.linspace(5.0, motor.peak_torque, 100))
    power = speed * torque
    efficiency = np.where(
        power <= motor.peak_power, power / (power + loss_power(motor, torque, speed)), np.nan
    )
    levels = (0.5, 0.7, 0.8, 0.85, 0.9, 0.92, 0.94, 0.95, 0.96)
    title = "b  Efficiency of motor and inverter, as assumed"
    return Sheet([contours(title, (_SPEED, speed), ("torque [N m]", torque), efficiency, levels)])


_MACHINE_PANELS = (
    cannot_be_drawn(
        "1.5",
        "",
        "Market of electric cars",
        "a forecast of another firm, no data are in the text",
        "diss.fig1.5",
    ),
    cannot_be_drawn(
        "1.13",
        "",
        "Double planetary drive of another maker",
        "only the caption of its curve is left",
        "diss.fig1.13",
    ),
    PublishedPanel("1.22", "a", _ROW, ("diss.fig1.22",), (_CAR,), over_time(_limits, _SPEED)),
    PublishedPanel("1.22", "b", _ROW, ("diss.fig1.22",), (_CAR,), _efficiency),
)


def _scheme(row: str, figure: str) -> PublishedPanel:
    return cannot_be_drawn(figure, "", row, _WHY, f"diss.fig{figure}")


_SCHEMES_PANELS = tuple(
    _scheme(row, f"{chapter}.{number}")
    for chapter, (row, numbers) in _ROWS.items()
    for number in numbers
)


_SIMULATION_PANELS = (
    *_simulated("torques at the shafts, methods 1 to 5", 1, "a", _quantity("torque")),
    *_simulated("speeds of the shafts, methods 1 to 5", 1, "b", _quantity("speed")),
    *_simulated("wheel efficiency, right", 2, "a", _efficiency_of_wheel("right")),
    *_simulated("wheel efficiency, left", 2, "b", _efficiency_of_wheel("left")),
    *_simulated("torques beside the efficiencies", 2, "v", _quantity("torque")),
)


PANELS = (*_MACHINE_PANELS, *_CYCLE_PANELS, *_SIMULATION_PANELS, *_BENCH_PANELS, *_SCHEMES_PANELS)
