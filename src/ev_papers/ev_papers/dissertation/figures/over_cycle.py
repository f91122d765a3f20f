"""How a quantity of both circuits is drawn over the cycle."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from ev_papers.dissertation.figures.circuit_curves import running_drive_efficiency, running_wheel_efficiency
from ev_papers.dissertation.figures.urban_mixed import lay_over_friction
from ev_papers.dissertation.figures.urban_sheets import sheet_over_cycle
from ev_papers.dissertation.measures.urban_cases import BENCH, FIVE, METHODS, SCENARIO, case
from ev_sim.figures.figure import Figure
from ev_sim.figures.panels import Curve, panel
from ev_sim.measures.samples import channel
from ev_sim.recording.recording import Recording
from ev_sim.verdicts.need import ScenarioNeed, ScenarioRuns
from ev_sim.verdicts.panels_page import PublishedPanel

SIDES = ("right", "left")
CYCLES, ON_BENCH = (
    {METHODS[name].number: ScenarioNeed(scenario, case(name, "pulse", 1).values, slow=True) for name in FIVE}
    for scenario in (SCENARIO, BENCH)
)


def run_of(driven: ScenarioRuns) -> Recording:
    """The only run of the scenario."""
    (run,) = driven.runs.values()
    return run


def driver_of(driven: ScenarioRuns) -> Mapping[str, Any]:
    """The parameters of the driver."""
    return driven.parameters["driver"]


def of_each_method(
    row: str,
    figure: Callable[[int], str],
    letter: str,
    draw: Callable[[ScenarioRuns], Figure],
    cycles: Mapping[int, ScenarioNeed] = CYCLES,
) -> tuple[PublishedPanel, ...]:
    """The same panel for methods 1 to 5; `figure` gives the number of the figure of a method."""
    return tuple(
        PublishedPanel(figure(number), letter, row, (_id(figure(number), letter),), (need,), draw)
        for number, need in cycles.items()
    )


def _id(figure: str, letter: str) -> str:
    return f"diss.fig{figure}" + (f".{letter}" if letter else "")


_OfSide = Callable[[ScenarioRuns, str], Curve]


def _draw(title: str, ylabel: str, sides: tuple[str, ...], curve: _OfSide) -> Callable[[ScenarioRuns], Figure]:
    def draw(driven: ScenarioRuns) -> Figure:
        shown = panel(title, ylabel, lambda: [curve(driven, side) for side in sides])
        return sheet_over_cycle([shown], run_of(driven), driver_of(driven))

    return draw


def recorded(title: str, ylabel: str, quantity: str) -> Callable[[ScenarioRuns], Figure]:
    """A recorded quantity of both front wheels."""

    def curve(driven: ScenarioRuns, side: str) -> Curve:
        run = run_of(driven)
        return Curve(run.time, channel(run, f"{quantity}.front_{side}"), side)

    return _draw(title, ylabel, SIDES, curve)


def torques(driven: ScenarioRuns) -> Figure:
    """Torques at the shafts of both motors."""
    return recorded("Motor torques", "torque [N m]", "motor_states.effort")(driven)


def speeds(driven: ScenarioRuns) -> Figure:
    """Speeds of the shafts of both motors."""
    return recorded("Motor speeds", "speed [rad/s]", "motor_states.velocity")(driven)


def wheel_efficiency(side: str) -> Callable[[ScenarioRuns], Figure]:
    """Eq 2.37 of one side since the start, over the friction of the road under its wheel."""

    def curve(driven: ScenarioRuns, side: str) -> Curve:
        return running_wheel_efficiency(run_of(driven), driven.vehicle, driver_of(driven), f"front_{side}", side)

    return _over_friction(_draw("Wheel efficiency since the start", "efficiency, friction [1]", (side,), curve), side)


def drive_efficiency(side: str) -> Callable[[ScenarioRuns], Figure]:
    """Eq 2.38 of one side since the start, over the friction of the road under its wheel."""

    def curve(driven: ScenarioRuns, side: str) -> Curve:
        return running_drive_efficiency(run_of(driven), driven.vehicle, driver_of(driven), f"front_{side}", side)

    return _over_friction(_draw("Drive efficiency since the start", "efficiency, friction [1]", (side,), curve), side)


def over_friction(draw: Callable[[ScenarioRuns], Figure]) -> Callable[[ScenarioRuns], Figure]:
    """A figure with the friction of the road under the right wheel on an axis of its own."""

    def both(driven: ScenarioRuns) -> Figure:
        figure, run = draw(driven), run_of(driven)
        friction = channel(run, "tire_forces.friction_coefficient.front_right")
        beside = figure.axes[0].twinx()
        beside.step(run.time[::10], friction[::10], where="post", color="0.6", linewidth=0.7)
        beside.set_ylim(0.0, 1.05)
        beside.set_ylabel("friction, right [1]", fontsize=8.0)
        beside.tick_params(labelsize=8.0)
        figure.subplots_adjust(right=0.93)
        return figure

    return both


def _over_friction(draw: Callable[[ScenarioRuns], Figure], side: str) -> Callable[[ScenarioRuns], Figure]:
    """The same figure with the largest friction of the road under a front wheel behind it, in grey."""

    def both(driven: ScenarioRuns) -> Figure:
        figure = draw(driven)
        lay_over_friction(figure.axes[0], run_of(driven), f"front_{side}")
        return figure

    return both
