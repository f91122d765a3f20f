"""Fig 1 of Shchur (2019): steps of the hand torque without (curve 1) and with the law (curve 2)."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from ev_sim.report.metric import NotMeasured
from ev_sim.report.papers import shchur2019 as paper
from ev_sim.report.quantities import derived
from ev_sim.report.quantities.step_response import StepResponse, first_peaks, step_response
from ev_sim.report.samples import channel, last, mean_between, run_named
from ev_sim.running.recording.recording import Recording
from ev_sim.verdicts.check import Measure, Number, smaller
from ev_sim.verdicts.declaration import Declaration, judged
from ev_sim.verdicts.need import ScenarioNeed, ScenarioRuns
from ev_sim.verdicts.sources.shchur2019.assumptions import FIVE_TIMES, SAMPLED
from ev_sim.verdicts.tolerance import absolute, between, relative

STEPS = ScenarioNeed("shchur2019_steps")
SETTLING_BAND = 0.05
WINDOW = 1.0  # mean values are taken over the last second [s]
_OBJECT, _CLOSED_LOOP = "object", "closed_loop"
_ALGEBRA = relative(0.005, "algebra, only the end of the window is left open")
_PEAKS = relative(0.05, SAMPLED)

_STEADY_2 = paper.CLOSED_LOOP.steady_angle((1 + paper.GAMMA) * paper.I_RATIO * paper.HAND_TORQUE_CLOSED_LOOP)
_STEADY_1 = paper.OBJECT.steady_angle(paper.I_RATIO * paper.HAND_TORQUE_OBJECT)


def _angle(run: Recording) -> np.ndarray:
    return channel(run, derived.ROAD_WHEEL_ANGLE)


def _response(driven: ScenarioRuns, name: str) -> StepResponse:
    run = run_named(driven.runs, name)
    return step_response(run.time, _angle(run), derived.hand_torque_step_time(run), SETTLING_BAND, WINDOW)


def _steady(name: str) -> Measure:
    return lambda driven: _response(driven, name).steady_value


def _overshoot(name: str) -> Measure:
    return lambda driven: _response(driven, name).overshoot


def _settling(name: str) -> Measure:
    return lambda driven: _response(driven, name).settling_time


def _peak(name: str, of: Callable[[list[tuple[float, float]]], float]) -> Measure:
    """`of` gets time after the step [s] and angle [rad] of the peaks, in their order."""

    def measure(driven: ScenarioRuns) -> float:
        run = run_named(driven.runs, name)
        return of(first_peaks(run.time - derived.hand_torque_step_time(run), _angle(run)))

    return measure


def _torque_after_step(driven: ScenarioRuns) -> tuple[np.ndarray, np.ndarray]:
    """Time after the step [s] and differential torque [N m], from the first instant at which the law answers."""
    run = run_named(driven.runs, _CLOSED_LOOP)
    torque = derived.differential_torque(run)
    answering = np.flatnonzero(torque)
    if not len(answering):
        raise NotMeasured("the law never answers")
    return run.time[answering[0] :] - derived.hand_torque_step_time(run), torque[answering[0] :]


def _lowest(driven: ScenarioRuns) -> tuple[float, float]:
    time, torque = _torque_after_step(driven)
    at = int(np.argmin(torque))
    return float(time[at]), float(torque[at])


def _final_torque(driven: ScenarioRuns) -> float:
    run = run_named(driven.runs, _CLOSED_LOOP)
    return mean_between(run, derived.differential_torque(run), *last(run, WINDOW))


_OVERSHOOT_1 = Number("%", paper.OBJECT.overshoot, absolute(1.0, SAMPLED), _overshoot(_OBJECT))
_LOWEST_TIME, _LOWEST_TORQUE = paper.lowest_differential_torque()

DECLARATIONS: tuple[Declaration, ...] = (
    judged("shchur.fig1a.1.steady", STEPS, Number("rad", _STEADY_1, _ALGEBRA, _steady(_OBJECT))),
    judged(
        "shchur.fig1a.1.overshoot",
        STEPS,
        _OVERSHOOT_1,
        Number("rad", paper.OBJECT.peak_angle(_STEADY_1), _PEAKS, _peak(_OBJECT, lambda peaks: peaks[0][1]), "peak"),
        Number("s", paper.OBJECT.peak_time, _PEAKS, _peak(_OBJECT, lambda peaks: peaks[0][0]), "time"),
        Number(
            "s", 2 * paper.OBJECT.peak_time, _PEAKS, _peak(_OBJECT, lambda peaks: peaks[1][0] - peaks[0][0]), "period"
        ),
    ),
    judged(
        "shchur.fig1a.1.settling",
        STEPS,
        Number("s", paper.OBJECT.settling_time(SETTLING_BAND), _PEAKS, _settling(_OBJECT)),
    ),
    judged(
        "shchur.fig1a.2.steady",
        STEPS,
        Number("rad", _STEADY_2, _ALGEBRA, _steady(_CLOSED_LOOP)),
        assumption=FIVE_TIMES,
    ),
    judged(
        "shchur.fig1a.2.overshoot",
        STEPS,
        Number("%", paper.CLOSED_LOOP.overshoot, absolute(1.0, SAMPLED), _overshoot(_CLOSED_LOOP)),
        Number("s", paper.CLOSED_LOOP.peak_time, _PEAKS, _peak(_CLOSED_LOOP, lambda peaks: peaks[0][0]), "time"),
    ),
    judged(
        "shchur.fig1a.2.settling",
        STEPS,
        Number("s", paper.CLOSED_LOOP.settling_time(SETTLING_BAND), _PEAKS, _settling(_CLOSED_LOOP)),
    ),
    judged(
        "shchur.fig1a.equal_ends",
        STEPS,
        Number(
            "1",
            1.0,
            relative(0.01, "by eqs 6 and 7 the ratio is 0.9993"),
            lambda driven: _response(driven, _CLOSED_LOOP).steady_value / _response(driven, _OBJECT).steady_value,
        ),
        assumption=FIVE_TIMES,
    ),
    judged(
        "shchur.fig1a.damped",
        STEPS,
        Number(
            "%",
            paper.CLOSED_LOOP.overshoot,
            between(-math.inf, 5.0, "an overshoot that is no longer seen as an oscillation"),
            _overshoot(_CLOSED_LOOP),
        ),
        smaller(
            "%",
            _overshoot(_CLOSED_LOOP),
            _overshoot(_OBJECT),
            0.5,
            "a step is sampled to a hundredth of this",
            "beside",
        ),
    ),
    judged(
        "shchur.fig1b.start",
        STEPS,
        Number(
            "N m",
            paper.differential_torque(paper.HAND_TORQUE_CLOSED_LOOP, 0.0),
            relative(0.01, "the column may have moved for one period"),
            lambda driven: _torque_after_step(driven)[1][0],
        ),
        assumption=FIVE_TIMES,
    ),
    judged(
        "shchur.fig1b.minimum",
        STEPS,
        Number("N m", _LOWEST_TORQUE, relative(0.03, SAMPLED), lambda driven: _lowest(driven)[1]),
        Number("s", _LOWEST_TIME, _PEAKS, lambda driven: _lowest(driven)[0], "at"),
        assumption=FIVE_TIMES,
    ),
    judged(
        "shchur.fig1b.end",
        STEPS,
        Number(
            "N m",
            paper.differential_torque(paper.HAND_TORQUE_CLOSED_LOOP, _STEADY_2),
            _ALGEBRA,
            _final_torque,
        ),
        assumption=FIVE_TIMES,
    ),
)
