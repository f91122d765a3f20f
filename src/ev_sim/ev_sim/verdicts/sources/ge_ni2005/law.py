"""What follows for the law itself: its targets, the torque they need, and the chatter without a boundary layer."""

from __future__ import annotations

import dataclasses

from ev_sim.report.metric import Metric
from ev_sim.report.papers import ge_ni2005 as paper
from ev_sim.report.quantities.two_rear_motors import CHATTER_WINDOW, chatter_at_its_target, slip
from ev_sim.report.samples import channel, run_named
from ev_sim.running.recording.recording import Recording
from ev_sim.verdicts.check import Basis, Comparison, Number, smaller
from ev_sim.verdicts.declaration import judged
from ev_sim.verdicts.need import ScenarioNeed, ScenarioRuns
from ev_sim.verdicts.published import published
from ev_sim.verdicts.sources.ge_ni2005.runs import of
from ev_sim.verdicts.tolerance import relative

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

DECLARATIONS = (
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
