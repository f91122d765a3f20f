"""The cycle of the dissertation: table 2.4, its windows, its length."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ev_msgs_py.parameters.csv_file import find_file
from ev_sim.verdicts.check import Number
from ev_sim.verdicts.declaration import Declaration, judged
from ev_sim.verdicts.need import ScenarioRuns
from ev_sim.verdicts.sources.dissertation.runs import MODEL
from ev_sim.verdicts.tolerance import absolute, relative

_GIVEN = "the driver is given table 2.4 (config/cycles/trrl_1_1.csv)"
_EXACT = relative(0.0, "exact")
_END = 580.0  # [s]
_KILOMETRE_PER_HOUR = 1 / 3.6  # [m/s]


def _points(driven: ScenarioRuns) -> np.ndarray:
    """Time [s] and speed [m/s] of the driver's profile, (n, 2)."""
    driver = driven.parameters["driver"]
    return np.column_stack((driver["speed_profile.time"], driver["speed_profile.speed"]))


def _beyond_the_table(driven: ScenarioRuns) -> float:
    """Largest difference of the profile from table 2.4 at the points of both [m/s]."""
    table = np.loadtxt(find_file("cycles/trrl_1_1.csv"), delimiter=",", skiprows=1)
    points = _points(driven)
    times = np.union1d(points[:, 0], table[:, 0])
    printed = np.interp(times, table[:, 0], table[:, 1] * _KILOMETRE_PER_HOUR)
    return float(np.abs(np.interp(times, points[:, 0], points[:, 1]) - printed).max())


def _length(driven: ScenarioRuns) -> float:
    points = _points(driven)
    return float((np.diff(points[:, 0]) * (points[1:, 1] + points[:-1, 1]) / 2).sum())


def _time_of(mode: str) -> Callable[[ScenarioRuns], float]:
    """How long the windows of a mode last [s]."""

    def measure(driven: ScenarioRuns) -> float:
        driver = driven.parameters["driver"]
        begin = [*driver["modes.begin"], _END]
        return float(np.diff(begin)[[each == mode for each in driver["modes.mode"]]].sum())

    return measure


_SECONDS = absolute(0.05, "one digit")

DECLARATIONS: tuple[Declaration, ...] = (
    judged(
        "diss.t2.4",
        MODEL,
        Number("1", 90.0, _EXACT, lambda driven: float(len(_points(driven))), "points"),
        Number("m/s", 0.0, absolute(1e-12, "exact, but for the unit"), _beyond_the_table, "largest difference"),
        inputs=_GIVEN,
    ),
    judged(
        "diss.fig2.12",
        MODEL,
        Number("m/s", 0.0, absolute(1e-12, "exact, but for the unit"), _beyond_the_table, "difference from table 2.4"),
        inputs=_GIVEN,
    ),
    judged(
        "diss.modes",
        MODEL,
        Number("1", 19.0, _EXACT, lambda driven: float(len(driven.parameters["driver"]["modes.begin"])), "windows"),
        Number("s", 355.2, _SECONDS, _time_of("traction"), "traction"),
        Number("s", 143.6, _SECONDS, _time_of("regen"), "regeneration"),
        Number("s", 81.2, _SECONDS, _time_of("stop"), "stop"),
        inputs="the driver is given the windows",
    ),
    judged(
        "diss.cycle.length",
        MODEL,
        Number("m", 4402.6, absolute(0.1, "one digit"), _length, "length"),
        Number("s", 580.0, _EXACT, lambda driven: float(_points(driven)[-1, 0]), "duration"),
        inputs=_GIVEN,
    ),
)
