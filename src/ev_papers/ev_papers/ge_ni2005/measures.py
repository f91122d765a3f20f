"""Measures of Ge & Ni (2005): the steady turn with equal torques, and the claimed changes by the law.

Each public function measures one number of published.csv; `run` is the run of the scenario that it is measured on.
"""

from __future__ import annotations

from ev_papers.ge_ni2005 import paper, quantities
from ev_papers.ge_ni2005.quantities import QUANTITIES, response_time, slip
from ev_stack.measures import motion
from ev_stack.measures.metric import channel, run_named
from ev_study.verdicts.need import ScenarioRuns, StudyCases

BASELINE = "equal_torque"
# A boundary layer as wide as any slip: what the reading `offset` adds to T* is k D, which gives the target.
WIDE = 1.0
OUTER_GAIN = 100.0  # k_R [N m]


def quantity(driven: ScenarioRuns, name: str, run: str) -> float:
    """One of the QUANTITIES of a turn, in its unit."""
    return QUANTITIES[name][1](run_named(driven.runs, run))


def studied(driven: StudyCases, quantity: str, case: str) -> float:
    """A quantity of ge_ni2005_wheel_speeds, of a case with `_` for each space of its name, in its unit."""
    return float(driven.results[case.replace("_", " ")].measured[quantity])


def slips_apart(driven: StudyCases, case: str) -> float:
    """Difference of the slips of both rear wheels there in the end [1]."""
    return studied(driven, "slip_left", case) - studied(driven, "slip_right", case)


def time_to_own_yaw_rate(driven: ScenarioRuns, run: str) -> float:
    """Time to 90 % of the yaw rate that the run itself reaches [s]."""
    return quantities.own_response_time(run_named(driven.runs, run))


def time_to_that_of_equal_torques(driven: ScenarioRuns, run: str) -> float:
    """Time to 90 % of the yaw rate that equal torques reach [s]."""
    return response_time(run_named(driven.runs, run), quantity(driven, "yaw_rate", BASELINE))


def chatter(driven: ScenarioRuns, run: str, target: float) -> float:
    """Chatter of the torques of a run that comes to its target slip [1], in [N m/s]."""
    return quantities.chatter_at_its_target(run_named(driven.runs, run), target)


def slip_over_target(driven: ScenarioRuns, side: str, run: str) -> float:
    """Slip of a rear wheel in the end over its target, l3* inside and l4* = l3* - K1 (w - delta u/L) outside [1]."""
    recording = run_named(driven.runs, run)
    yaw_rate = motion.value_at(recording, channel(recording, motion.YAW_RATE), paper.INSTANT)
    outside = paper.YAW_GAIN * (yaw_rate - paper.STEERING * paper.SPEED / paper.WHEELBASE)
    target = paper.TARGET - (outside if side == "right" else 0.0)
    return motion.value_at(recording, slip(recording, side), paper.INSTANT) / target


def outer_target(driven: ScenarioRuns) -> float:
    """The law's target slip of the outer wheel when the wheels have just been turned [1]."""
    run = run_named(driven.runs, "offset")
    added = channel(run, "torque_request.drive.rear_right")[0] - paper.TORQUE
    return float(slip(run, "right")[0] + added * WIDE / OUTER_GAIN)


def change_of_target(driven: ScenarioRuns) -> float:
    """How far the printed target lies above that [1]."""
    return paper.TARGET - outer_target(driven)
