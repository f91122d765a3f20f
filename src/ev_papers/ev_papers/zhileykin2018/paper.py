"""Zhileykin (2018): what the source gives its car and its run, as our runs have it.

What Zhileykin & Eranosyan (2018) print, and the thresholds that their words need.
M. M. Zhileykin, A. V. Eranosyan, "Improvement of four-wheel drive vehicle controllability with a connected front axle
through the redistribution of torque" (in Russian), Bauman University, 2018. Printed values are written down here once
more instead of being taken from the run, so that a run with other parameters is judged against the paper all the same.
"""

from __future__ import annotations

import math

import numpy as np

from ev_papers.zhileykin2018.quantities import front_share
from ev_sim.measures.metric import NotMeasured
from ev_sim.measures.motion import STEERING_WHEEL_ANGLE
from ev_sim.measures.samples import channel, run_named
from ev_sim.verdicts.check import Number, absolute, holds, relative
from ev_sim.verdicts.declaration import Declaration, judged
from ev_sim.verdicts.need import ScenarioNeed, ScenarioRuns

MASS = 2400.0  # [kg]
FULL_SLIP_FRICTION = 0.35  # mu_s, "ice with snow" [1]
INITIAL_SPEED = 25.0 / 3.6  # [m/s]
LARGEST_FRONT_SHARE = 0.5  # [1]
STEERING = (2.0, 3.0)  # the third second, in which the steering wheel is turned [s]

LIMIT = math.radians(15.0)  # sideslip angle beyond which the rear axle has slid out [rad]; assumed, the source has none
SWING = 0.005  # [1], least way of a share between two turn-arounds; assumed: what moves less is no oscillation
CALM = 1  # turn-arounds of one share that entering the bend explains


BEND = ScenarioNeed("zhileykin2018")
NOMINAL = "k1"
_EXACT = relative(1e-12, "an input, but for rounding")


def _initial_speed(driven: ScenarioRuns) -> float:
    return float(channel(run_named(driven.runs, NOMINAL), "twist.longitudinal")[0])


def _front_shares(driven: ScenarioRuns) -> np.ndarray:
    """Front shares of all runs in which the law shares out the torque."""
    return np.concatenate([front_share(run_named(driven.runs, name)) for name in ("k05", NOMINAL, "equality")])


def _turns(driven: ScenarioRuns) -> np.ndarray:
    """The instants at which the steering wheel has begun and ended to turn [s]."""
    run = run_named(driven.runs, NOMINAL)
    moves = np.flatnonzero(np.diff(channel(run, STEERING_WHEEL_ANGLE)))
    if not len(moves):
        raise NotMeasured("the steering wheel never turns")
    return run.time[[moves[0], moves[-1] + 1]]


DECLARATIONS: tuple[Declaration, ...] = (
    judged(
        "zhil.mass",
        BEND,
        Number("kg", MASS, _EXACT, lambda driven: driven.vehicle.mass),
        inputs="the file of the car has it",
    ),
    judged(
        "zhil.mu",
        BEND,
        Number("1", FULL_SLIP_FRICTION, _EXACT, lambda driven: driven.vehicle.tyre.coefficients[0]),
        inputs="the file of the car has it, as mu_s of its tyre curve",
    ),
    judged("zhil.v0", BEND, Number("m/s", INITIAL_SPEED, _EXACT, _initial_speed), inputs="the run begins with it"),
    judged(
        "zhil.share_range",
        BEND,
        Number("1", LARGEST_FRONT_SHARE, _EXACT, lambda driven: _front_shares(driven).max(), "largest front"),
        holds(lambda driven: _front_shares(driven).min() >= 0.0, "a sign", "never negative"),
        inputs="the law is limited to it",
    ),
    judged(
        "zhil.steer_time",
        BEND,
        Number("s", STEERING[0], absolute(0.0101, "one control period"), lambda driven: _turns(driven)[0], "begin"),
        Number("s", STEERING[1], absolute(0.0101, "one control period"), lambda driven: _turns(driven)[1], "end"),
        inputs="the steering robot is told so",
    ),
)
