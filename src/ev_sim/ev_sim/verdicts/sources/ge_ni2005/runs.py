"""The runs that Ge & Ni (2005) are judged on, and how a quantity is taken from one of them."""

from __future__ import annotations

from collections.abc import Callable

from ev_sim.report.quantities.two_rear_motors import QUANTITIES, Measure
from ev_sim.report.samples import run_named
from ev_sim.verdicts.need import ScenarioNeed, ScenarioRuns

BASELINE = "equal_torque"
READINGS = ("rate", "offset", "increment")
FREE_SPEED, FULL_CAR = "_free_speed", "_full_car"
STEADY = ScenarioNeed("ge_ni2005", runs=(BASELINE,))
COMPARED = ScenarioNeed("ge_ni2005", runs=(BASELINE, *READINGS))
COMPARED_FREE = ScenarioNeed("ge_ni2005", runs=tuple(f"{name}{FREE_SPEED}" for name in (BASELINE, *READINGS)))
CASES = ("", FREE_SPEED, FULL_CAR, FULL_CAR + FREE_SPEED)  # what the names of runs end with: car and speed
SETTLED = "T* on each rear wheel, settled before the turn, the wheels turned at once"
EACH = f"{SETTLED}; T = k sgn(D) read as rate, offset and increment, each judged"


def of(run: str, measure: Measure) -> Callable[[ScenarioRuns], float]:
    """A measure of one of the runs."""
    return lambda driven: measure(run_named(driven.runs, run))


def quantity(name: str, run: str) -> Callable[[ScenarioRuns], float]:
    """A quantity of one of the runs by its name."""
    return of(run, QUANTITIES[name][1])
