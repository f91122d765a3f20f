"""Figures 5.1 to 5.26: the five methods on the test bench. We draw the same quantities from the model."""

from __future__ import annotations

from collections.abc import Callable

from ev_sim.verdicts.panel import cannot_be_drawn
from ev_sim.verdicts.panels.dissertation.over_cycle import (
    currents,
    drive_efficiency,
    speeds,
    torques,
    torques_and_friction,
    voltage,
)
from ev_sim.verdicts.panels.dissertation.runs import of_each_method

_FIGURES_OF_A_METHOD = 5


def _figure(place: int) -> Callable[[int], str]:
    return lambda method: f"5.{_FIGURES_OF_A_METHOD * (method - 1) + place}"


PANELS = (
    *of_each_method("Bench, torques, methods 1 to 5", _figure(1), "", torques),
    *of_each_method("Bench, speeds, methods 1 to 5", _figure(2), "", speeds),
    *of_each_method("Bench, currents, methods 1 to 5", _figure(3), "", currents),
    *of_each_method("Bench, voltages, methods 1 to 5", _figure(4), "", voltage),
    *of_each_method("Bench, drive efficiency, right", _figure(5), "a", drive_efficiency("right")),
    *of_each_method("Bench, drive efficiency, left", _figure(5), "b", drive_efficiency("left")),
    *of_each_method("Bench, torques and friction", _figure(5), "v", torques_and_friction),
    cannot_be_drawn(
        "5.26", "", "Model against bench", "it needs the torques measured on the bench, which are lost", "diss.fig5.26"
    ),
)
