"""Fig 1 of Shchur (2019): steps of the hand torque without (curve 1) and with the law (curve 2)."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from ev_papers.shchur2019 import paper
from ev_papers.shchur2019.assumptions import FIVE_TIMES, SAMPLED
from ev_sim.measures import motion
from ev_sim.measures.metric import NotMeasured
from ev_sim.measures.samples import channel, last, mean_between, run_named
from ev_sim.recording.recording import Recording
from ev_sim.verdicts.check import Measure, Number, Tolerance, absolute, between, relative, smaller
from ev_sim.verdicts.declaration import Declaration, judged
from ev_sim.verdicts.need import ScenarioNeed, ScenarioRuns


@dataclass(frozen=True, slots=True)
class StepResponse:
    """What a step response is judged by.

    steady_value: mean over the last second, in the unit of the response.
    overshoot: how far the extreme in the direction of the step lies beyond the steady value, as a percentage of the
        change from the value at the step to the steady value; zero if it never does.
    settling_time: from the step to the last crossing into the band around the steady value [s]; the crossing is
        interpolated linearly between two samples; zero if the response never leaves the band.
    """

    steady_value: float
    overshoot: float
    settling_time: float


def step_response(
    time: np.ndarray, response: np.ndarray, step_time: float, band: float = 0.05, window: float = 1.0
) -> StepResponse:
    """Judge the response to a step at `step_time`, sampled as (n,) over time (n,) [s].

    `band` is the half width of the settling band as a fraction of the change. NotMeasured if fewer than two windows
    were recorded after the step, if the response does not change, or if it has not settled into the band by the
    beginning of the last window (its mean would not be the steady value then).
    """
    after = time >= step_time
    time, response = time[after], response[after]
    if len(time) < 2 or time[-1] - time[0] < 2 * window:
        raise NotMeasured(f"less than {2 * window:g} s were recorded after the step")
    steady_value = float(response[time >= time[-1] - window].mean())
    change = steady_value - response[0]
    if change == 0.0:
        raise NotMeasured("there is no change after the step")
    deviation = (response - steady_value) / change
    settling_time = _settling_time(time, deviation, band)
    if settling_time > time[-1] - window - step_time:
        raise NotMeasured(f"the response has not settled to {100 * band:g} % before the last {window:g} s of the run")
    return StepResponse(steady_value, 100 * max(0.0, float(deviation.max())), settling_time)


def first_peaks(time: np.ndarray, response: np.ndarray) -> list[tuple[float, float]]:
    """Time [s] and value of the local maxima of a response (n,), in their order; NotMeasured if there are not two."""
    inner = response[1:-1]
    peaks = np.flatnonzero((inner > response[:-2]) & (inner >= response[2:])) + 1
    if len(peaks) < 2:
        raise NotMeasured("the response has less than two peaks")
    return [(float(time[at]), float(response[at])) for at in peaks]


def _settling_time(time: np.ndarray, deviation: np.ndarray, band: float) -> float:
    outside = np.flatnonzero(np.abs(deviation) > band)
    if not len(outside):
        return 0.0
    last = outside[-1]
    if last == len(time) - 1:
        return float("inf")
    edge = np.copysign(band, deviation[last])
    fraction = (deviation[last] - edge) / (deviation[last] - deviation[last + 1])
    return float(time[last] + fraction * (time[last + 1] - time[last]) - time[0])


STEPS = ScenarioNeed("shchur2019_steps")
SETTLING_BAND = 0.05
WINDOW = 1.0  # mean values are taken over the last second [s]
_OBJECT, _CLOSED_LOOP = "object", "closed_loop"
_ALGEBRA = relative(0.005, "algebra, only the end of the window is left open")
_PEAKS = relative(0.05, SAMPLED)

_STEADY_2 = paper.CLOSED_LOOP.steady_angle((1 + paper.GAMMA) * paper.I_RATIO * paper.HAND_TORQUE_CLOSED_LOOP)
_STEADY_1 = paper.OBJECT.steady_angle(paper.I_RATIO * paper.HAND_TORQUE_OBJECT)


def _angle(run: Recording) -> np.ndarray:
    return channel(run, motion.ROAD_WHEEL_ANGLE)


def _response(driven: ScenarioRuns, name: str) -> StepResponse:
    run = run_named(driven.runs, name)
    return step_response(run.time, _angle(run), motion.hand_torque_step_time(run), SETTLING_BAND, WINDOW)


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
        return of(first_peaks(run.time - motion.hand_torque_step_time(run), _angle(run)))

    return measure


def _torque_after_step(driven: ScenarioRuns) -> tuple[np.ndarray, np.ndarray]:
    """Time after the step [s] and differential torque [N m], from the first instant at which the law answers."""
    run = run_named(driven.runs, _CLOSED_LOOP)
    torque = motion.differential_torque(run)
    answering = np.flatnonzero(torque)
    if not len(answering):
        raise NotMeasured("the law never answers")
    return run.time[answering[0] :] - motion.hand_torque_step_time(run), torque[answering[0] :]


def _lowest(driven: ScenarioRuns) -> tuple[float, float]:
    time, torque = _torque_after_step(driven)
    at = int(np.argmin(torque))
    return float(time[at]), float(torque[at])


def _final_torque(driven: ScenarioRuns) -> float:
    run = run_named(driven.runs, _CLOSED_LOOP)
    return mean_between(run, motion.differential_torque(run), *last(run, WINDOW))


_OVERSHOOT_1 = Number("%", paper.OBJECT.overshoot, absolute(1.0, SAMPLED), _overshoot(_OBJECT))
_LOWEST_TIME, _LOWEST_TORQUE = paper.lowest_differential_torque()

_STEPS_DECLARATIONS: tuple[Declaration, ...] = (
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
        "shchur.fig1a.2.steady", STEPS, Number("rad", _STEADY_2, _ALGEBRA, _steady(_CLOSED_LOOP)), assumption=FIVE_TIMES
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
        Number("N m", paper.differential_torque(paper.HAND_TORQUE_CLOSED_LOOP, _STEADY_2), _ALGEBRA, _final_torque),
        assumption=FIVE_TIMES,
    ),
)


def held(driven: ScenarioRuns) -> Tolerance:
    """Of torques while an angle is held at rest."""
    if driven.parameters.get("plant", {}).get("drive") == "switched":
        return relative(0.01, "ripple of switched drives")
    return relative(0.005, "algebra, only the end of the window is left open")


def _hand_torque(run: Recording) -> np.ndarray:
    return channel(run, motion.HAND_TORQUE)


def _mean(name: str, quantity: Callable[[Recording], np.ndarray]) -> Measure:
    def measure(driven: ScenarioRuns) -> float:
        run = run_named(driven.runs, name)
        return motion.mean_while_held(run, quantity(run), paper.TURN_ANGLE, *last(run, WINDOW))

    return measure


_MANUAL = paper.hand_torque_manual(paper.TURN_ANGLE)
ASSISTED = paper.hand_torque_assisted(paper.TURN_ANGLE)

_HOLDING_DECLARATIONS: tuple[Declaration, ...] = (
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
            _mean("hold_assisted", motion.differential_torque),
        ),
        assumption=FIVE_TIMES,
    ),
)


DECLARATIONS = (*_STEPS_DECLARATIONS, *_HOLDING_DECLARATIONS)
