"""One cycle with each of the five methods, and what the figures of chapters 3 and 5 have in common."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from ev_sim.report.figures.figure import Figure
from ev_sim.running.recording.recording import Recording
from ev_sim.study.urban_cases import BENCH, FIVE, METHODS, SCENARIO, case
from ev_sim.verdicts.need import ScenarioNeed, ScenarioRuns
from ev_sim.verdicts.panel import PublishedPanel

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
