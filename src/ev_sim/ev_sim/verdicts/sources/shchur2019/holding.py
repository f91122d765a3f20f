"""Shchur (2019): what holds 30 deg at rest, without and with the law."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ev_sim.report.papers import shchur2019 as paper
from ev_sim.report.quantities import derived
from ev_sim.report.samples import channel, last, run_named
from ev_sim.running.recording.recording import Recording
from ev_sim.verdicts.check import Measure, Number
from ev_sim.verdicts.declaration import Declaration, judged
from ev_sim.verdicts.need import ScenarioRuns
from ev_sim.verdicts.sources.shchur2019.assumptions import FIVE_TIMES
from ev_sim.verdicts.sources.shchur2019.steps import STEPS, WINDOW
from ev_sim.verdicts.tolerance import Tolerance, relative


def held(driven: ScenarioRuns) -> Tolerance:
    """Of torques while an angle is held at rest."""
    if driven.parameters.get("plant", {}).get("drive") == "switched":
        return relative(0.01, "ripple of switched drives")
    return relative(0.005, "algebra, only the end of the window is left open")


def _hand_torque(run: Recording) -> np.ndarray:
    return channel(run, derived.HAND_TORQUE)


def _mean(name: str, quantity: Callable[[Recording], np.ndarray]) -> Measure:
    def measure(driven: ScenarioRuns) -> float:
        run = run_named(driven.runs, name)
        return derived.mean_while_held(run, quantity(run), paper.TURN_ANGLE, *last(run, WINDOW))

    return measure


_MANUAL = paper.hand_torque_manual(paper.TURN_ANGLE)
ASSISTED = paper.hand_torque_assisted(paper.TURN_ANGLE)

DECLARATIONS: tuple[Declaration, ...] = (
    judged("shchur.hold30.manual", STEPS, Number("N m", _MANUAL, held, _mean("hold_manual", _hand_torque))),
    judged(
        "shchur.hold30.assisted",
        STEPS,
        Number("N m", ASSISTED, held, _mean("hold_assisted", _hand_torque)),
        assumption=FIVE_TIMES,
    ),
    judged(
        "shchur.hold30.dm",
        STEPS,
        Number(
            "N m",
            paper.differential_torque(ASSISTED, paper.TURN_ANGLE),
            held,
            _mean("hold_assisted", derived.differential_torque),
        ),
        assumption=FIVE_TIMES,
    ),
)
