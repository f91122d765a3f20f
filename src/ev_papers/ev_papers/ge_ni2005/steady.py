"""The steady turn with equal torques, which follows from the printed equations and parameters."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import numpy as np

from ev_papers.ge_ni2005 import paper
from ev_papers.ge_ni2005.claims import BASELINE, SETTLED, STEADY, of, quantity
from ev_papers.ge_ni2005.quantities import (
    CHATTER_WINDOW,
    QUANTITIES,
    at_the_end,
    chatter_at_its_target,
    ground_speed,
    rim_speed,
    slip,
)
from ev_sim.measures import motion
from ev_sim.measures.metric import Metric
from ev_sim.measures.samples import channel, run_named
from ev_sim.recording.recording import Recording
from ev_sim.verdicts.check import Basis, Comparison, Number, between, relative, smaller
from ev_sim.verdicts.declaration import Declaration, judged
from ev_sim.verdicts.need import ScenarioNeed, ScenarioRuns
from ev_sim.verdicts.sources import published

SMALL_ANGLES = relative(0.005, "the closed form takes sines of 2 deg for the angle; measured are 0.06 %")
STEEP = relative(0.02, "steep curve: 1 % of force is 1.5 % of slip")
SPEEDS = relative(0.005, "small angles")
BEGINNING = 0.2  # [s], the time that the radius is left to come down from infinity

_turn = paper.steady_turn()


def _motion(id: str, name: str, value: float) -> Declaration:
    number = Number(QUANTITIES[name][0], value, SMALL_ANGLES, quantity(name, BASELINE))
    return judged(id, STEADY, number)


def _loads() -> tuple[Number, ...]:
    def measure(side: str) -> Callable[[ScenarioRuns], float]:
        return of(BASELINE, at_the_end(lambda run: channel(run, f"tire_forces.load.rear_{side}")))

    left, right = paper.rear_loads()
    return (
        Number("N", left, SMALL_ANGLES, measure("left"), "N_3"),
        Number("N", right, SMALL_ANGLES, measure("right"), "N_4"),
    )


def _slips() -> tuple[Number, ...]:
    left, right = map(paper.slip_of, paper.rear_loads())
    straight = of(BASELINE, lambda run: float(slip(run, "left")[0]))
    return (
        Number("1", left, STEEP, quantity("slip_rear_left", BASELINE), "l3"),
        Number("1", right, STEEP, quantity("slip_rear_right", BASELINE), "l4"),
        Number("1", paper.slip_of(paper.REAR_LOAD), STEEP, straight, "straight"),
    )


def _speeds() -> tuple[Number, ...]:
    def measure(of_wheel: Callable[..., np.ndarray], side: str) -> Callable[[ScenarioRuns], float]:
        def value(driven: ScenarioRuns) -> float:
            run = run_named(driven.runs, BASELINE)
            return motion.value_at(run, of_wheel(run, side, driven.vehicle), paper.INSTANT)

        return value

    (left, right), loads = paper.rear_speeds(), paper.rear_loads()
    rims = [speed / (1.0 - paper.slip_of(load)) for speed, load in zip((left, right), loads, strict=True)]
    return (
        Number("m/s", left, SPEEDS, measure(ground_speed, "left"), "V_3"),
        Number("m/s", right, SPEEDS, measure(ground_speed, "right"), "V_4"),
        Number("m/s", rims[0], SPEEDS, measure(rim_speed, "left"), "rim 3"),
        Number("m/s", rims[1], SPEEDS, measure(rim_speed, "right"), "rim 4"),
    )


def _largest(values: Callable[[Recording], np.ndarray], since: float) -> Callable[[ScenarioRuns], float]:
    def largest(driven: ScenarioRuns) -> float:
        run = run_named(driven.runs, BASELINE)
        return float(np.abs(values(run)[(run.time >= since) & (run.time <= paper.INSTANT)]).max())

    return largest


_STEADY_DECLARATIONS = (
    _motion("ge.eq.yaw_rate", "yaw_rate", _turn.yaw_rate),
    _motion("ge.eq.beta", "sideslip", _turn.sideslip),
    _motion("ge.eq.v", "lateral_speed", _turn.lateral_speed),
    _motion("ge.eq.radius", "radius", _turn.radius),
    _motion("ge.eq.centripetal", "centripetal_acceleration", _turn.centripetal_acceleration),
    judged("ge.eq.loads", STEADY, *_loads()),
    judged("ge.eq.slips", STEADY, *_slips(), assumption="T* on each rear wheel"),
    judged("ge.eq.speeds", STEADY, *_speeds(), assumption="T* on each rear wheel (rim speeds)"),
    judged(
        "ge.fig4b.axis",
        STEADY,
        Number("m", 70.0, between(0.0, 70.0, "inside the axis"), _largest(motion.radius_of_path, BEGINNING)),
        assumption=SETTLED,
    ),
    judged(
        "ge.fig4c.axis",
        STEADY,
        Number("m/s^2", 0.6, between(0.0, 0.6, "inside the axis"), _largest(motion.lateral_acceleration_on_path, 0.0)),
        assumption=SETTLED,
    ),
)


SWITCHED = "_switched"
SHORT = ScenarioNeed("ge_ni2005", runs=("increment", "increment" + SWITCHED))
LONG = ScenarioNeed("ge_ni2005", runs=("rate", "rate" + SWITCHED), duration=15.0)
STRAIGHT = ScenarioNeed("ge_ni2005", (("steering_column", "profile.angle", (0.0,)),), ("increment",))
# A boundary layer as wide as any slip: what `offset` adds to T* is k D, which tells the target.
WIDE = 1.0
AT_ONCE = ScenarioNeed("ge_ni2005", (("electronic_differential", "layer_width", WIDE),), ("offset",), duration=0.01)
OUTER_GAIN = 100.0  # k_R [N m]
LOWER_TARGET = 0.088  # of the runs *_lower_target: between the slips of both wheels with equal torques [1]
CALM, CALM_WHY = 0.9, "gone: less than a tenth of that without layer, at the same control period"


def chatters(reading: str, target: float, name: str, infix: str = "") -> Comparison:
    """The boundary layer takes the chatter of a reading away, in a run that comes to its target slip [1]."""

    def chatter(run: Recording) -> float:
        return chatter_at_its_target(run, target)

    run = reading + infix
    return smaller("N m/s", of(run, chatter), of(run + SWITCHED, chatter), CALM, CALM_WHY, name)


def _long(check: Comparison) -> Comparison:
    """The same on the second of two needs."""
    return dataclasses.replace(
        check, measure=lambda _, longer: check.measure(longer), against=lambda _, longer: check.against(longer)
    )


def _short(check: Comparison) -> Comparison:
    """The same on the first of two needs."""
    return dataclasses.replace(
        check, measure=lambda short, _: check.measure(short), against=lambda short, _: check.against(short)
    )


def _mean_torque(run: Recording) -> float:
    late = run.time >= run.time[-1] - CHATTER_WINDOW
    return float(channel(run, "torque_request.drive.rear_left")[late].mean())


def outer_target(driven: ScenarioRuns) -> float:
    """The law's target slip of the outer wheel when the wheels have just been turned [1]."""
    run = run_named(driven.runs, "offset")
    added = channel(run, "torque_request.drive.rear_right")[0] - paper.TORQUE
    return float(slip(run, "right")[0] + added * WIDE / OUTER_GAIN)


def within_the_figures(driven: ScenarioRuns) -> dict[str, Metric]:
    """The chatter within the 3 s of the figures by id and run: at the printed target, and at a lower one of ours."""
    of_id, lower = published("ge_ni2005")["ge.claim.chatter"], LOWER_TARGET
    checks = {"increment": (chatters("increment", paper.TARGET, ""), "T = k sgn(D) read as increment")}
    for reading in ("rate", "offset"):
        assumption = f"T = k sgn(D) read as {reading}; target slip CHANGED from {paper.TARGET:g} to {lower:g}"
        checks[f"{reading}_lower_target"] = (chatters(reading, lower, "", "_lower_target"), assumption)
    return {
        f"ge.claim.chatter.{run}": check.metric(Basis(of_id, assumption), (driven,))
        for run, (check, assumption) in checks.items()
    }


_turned = paper.turn_in_difference()

_LAW_DECLARATIONS = (
    judged(
        "ge.claim.chatter",
        (SHORT, LONG),
        _short(chatters("increment", paper.TARGET, "increment")),
        _long(chatters("rate", paper.TARGET, "rate, 15 s")),
        assumption="T = k sgn(D) read as rate and increment; offset never comes to the printed target slip of 0.19",
    ),
    judged(
        "ge.target",
        STRAIGHT,
        Number("N m", paper.target_torque(), relative(0.01, "flat curve near its peak"), of("increment", _mean_torque)),
        assumption="held straight by the reading increment, mean over its chatter",
    ),
    judged(
        "ge.turn_in",
        AT_ONCE,
        Number("1", _turned, relative(0.01, "small angles"), lambda driven: paper.TARGET - outer_target(driven), "dl*"),
        Number("1", paper.TARGET - _turned, relative(0.01, "small angles"), outer_target, "l4*"),
        assumption="K1 = 0.11, print damaged",
    ),
)


DECLARATIONS = (*_STEADY_DECLARATIONS, *_LAW_DECLARATIONS)
