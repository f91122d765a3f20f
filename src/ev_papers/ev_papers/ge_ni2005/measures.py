"""Measures of Ge & Ni (2005): quantities of a turn, responses, chatter and targets of the law.

Each public function measures one number of published.csv; `run` is the run of the scenario that it
is measured on.
"""

from __future__ import annotations

from ev_papers.ge_ni2005 import paper, quantities
from ev_papers.ge_ni2005.quantities import QUANTITIES, slip
from ev_stack.measures import motion
from ev_stack.measures.metric import channel, run_named
from ev_study.verdicts.need import ScenarioRuns, StudyCases

BASELINE = "equal_torque"
# Width of the boundary layer beyond any slip [1]: there the reading `offset` adds k D to T*, which
# gives the target slip.
WIDE = 1.0
OUTER_GAIN = 100.0  # k_R [N m]


def quantity(driven: ScenarioRuns, name: str, run: str) -> float:
    """One of the QUANTITIES of a turn, in its unit."""
    return QUANTITIES[name].of(run_named(driven.runs, run))


def studied(driven: StudyCases, quantity: str, case: str) -> float:
    """Quantity of a case of ge_ni2005_wheel_speeds; `_` stands for each space of its name."""
    return float(driven.results[case.replace("_", " ")].measured[quantity])


def slips_apart(driven: StudyCases, case: str) -> float:
    """Difference of the slips of both rear wheels in the end of a case [1]."""
    return studied(driven, "slip_left", case) - studied(driven, "slip_right", case)


def time_to_own_yaw_rate(driven: ScenarioRuns, run: str) -> float:
    """Time to 90 % of the yaw rate that the run itself reaches [s]."""
    return quantities.own_response_time(run_named(driven.runs, run))


def time_to_that_of_equal_torques(driven: ScenarioRuns, run: str) -> float:
    """Time to 90 % of the yaw rate that equal torques reach [s]."""
    final = quantities.yaw_rate(run_named(driven.runs, BASELINE))
    return quantities.response_time(run_named(driven.runs, run), final)


def chatter(driven: ScenarioRuns, run: str, target: float) -> float:
    """Chatter of the torques of a run that comes to its target slip [1], in [N m/s]."""
    return quantities.chatter_at_its_target(run_named(driven.runs, run), target)


def slip_over_target(driven: ScenarioRuns, side: str, run: str) -> float:
    """Slip of a rear wheel in the end over its target [1].

    The target is l3* inside and l4* = l3* - K1 (w - delta u/L) outside (eq 6).
    """
    recording = run_named(driven.runs, run)
    target = paper.TARGET
    if side == "right":
        neutral = paper.STEERING * paper.SPEED / paper.WHEELBASE
        target -= paper.YAW_GAIN * (quantities.yaw_rate(recording) - neutral)
    return motion.value_at(recording, slip(recording, side), paper.INSTANT) / target


def outer_target(driven: ScenarioRuns) -> float:
    """Target slip of the outer wheel when the wheels have just been turned [1]."""
    run = run_named(driven.runs, "offset")
    added = channel(run, "torque_request.drive.rear_right")[0] - paper.TORQUE
    return float(slip(run, "right")[0] + added * WIDE / OUTER_GAIN)


def change_of_target(driven: ScenarioRuns) -> float:
    """Printed target slip less that [1]."""
    return paper.TARGET - outer_target(driven)
