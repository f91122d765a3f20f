"""Figures 3.1 to 3.10: the five methods in simulation."""

from __future__ import annotations

from ev_sim.verdicts.panels.dissertation.over_cycle import speeds, torques, wheel_efficiency
from ev_sim.verdicts.panels.dissertation.runs import of_each_method


def _signals(method: int) -> str:
    return f"3.{2 * method - 1}"


def _efficiencies(method: int) -> str:
    return f"3.{2 * method}"


PANELS = (
    *of_each_method("Simulation, torques at the shafts, methods 1 to 5", _signals, "a", torques),
    *of_each_method("Simulation, speeds of the shafts, methods 1 to 5", _signals, "b", speeds),
    *of_each_method("Simulation, wheel efficiency, right", _efficiencies, "a", wheel_efficiency("right")),
    *of_each_method("Simulation, wheel efficiency, left", _efficiencies, "b", wheel_efficiency("left")),
    *of_each_method("Simulation, torques beside the efficiencies", _efficiencies, "v", torques),
)
