"""Figures 5.1 to 5.26: the five methods on the test bench, as its channels show them."""

from __future__ import annotations

from collections.abc import Callable

from ev_sim.report.figures.figure import Figure
from ev_sim.report.figures.panels import Curve, panel
from ev_sim.report.figures.urban_sheets import sheet_over_cycle
from ev_sim.report.samples import channel
from ev_sim.verdicts.need import ScenarioRuns
from ev_sim.verdicts.panel import PublishedPanel
from ev_sim.verdicts.panels.dissertation.over_cycle import drive_efficiency, over_friction, recorded
from ev_sim.verdicts.panels.dissertation.runs import CYCLES, ON_BENCH, driver_of, of_each_method, run_of

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


PANELS = (
    *of_each_method("Bench, torques, methods 1 to 5", _figure(1), "", _TORQUES, ON_BENCH),
    *of_each_method("Bench, speeds, methods 1 to 5", _figure(2), "", _SPEEDS, ON_BENCH),
    *of_each_method("Bench, currents, methods 1 to 5", _figure(3), "", _CURRENTS, ON_BENCH),
    *of_each_method("Bench, voltages, methods 1 to 5", _figure(4), "", _VOLTAGES, ON_BENCH),
    *of_each_method("Bench, drive efficiency, right", _figure(5), "a", drive_efficiency("right"), ON_BENCH),
    *of_each_method("Bench, drive efficiency, left", _figure(5), "b", drive_efficiency("left"), ON_BENCH),
    *of_each_method("Bench, torques and friction", _figure(5), "v", over_friction(_TORQUES), ON_BENCH),
    PublishedPanel("5.26", "", "Model against bench", ("diss.fig5.26",), (CYCLES[1], ON_BENCH[1]), _model_and_bench),
)
