"""Measures of Ge & Ni (2005): the steady turn with equal torques, and the claimed changes by the law.

Each public function measures one number of published.csv; `run` is the run of the scenario that it is measured on.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from ev_papers.ge_ni2005 import paper, quantities
from ev_papers.ge_ni2005.quantities import CHATTER_WINDOW, QUANTITIES, response_time, slip
from ev_sim.measures import motion
from ev_sim.measures.metric import NotMeasured, channel, run_named
from ev_sim.recording.recording import Recording
from ev_study.verdicts.need import ScenarioRuns, StudyCases

BASELINE = "equal_torque"
# A boundary layer as wide as any slip: what the reading `offset` adds to T* is k D, which gives the target.
WIDE = 1.0
OUTER_GAIN = 100.0  # k_R [N m]


def quantity(driven: ScenarioRuns, name: str, run: str) -> float:
    """One of the QUANTITIES of a turn, in its unit."""
    return QUANTITIES[name][1](run_named(driven.runs, run))


def over(driven: ScenarioRuns, other: ScenarioRuns, name: str, run: str) -> float:
    """One of the QUANTITIES over that with other parameters [1]."""
    return quantity(driven, name, run) / quantity(other, name, run)


def tyre(driven: ScenarioRuns, place: float) -> float:
    """A coefficient of the tyre's curve [1]."""
    return driven.vehicle.tyre.coefficients[int(place)]


def steered(driven: ScenarioRuns, run: str) -> float:
    """Road-wheel angle in the end [rad]."""
    return float(channel(run_named(driven.runs, run), motion.ROAD_WHEEL_ANGLE)[-1])


def studied(driven: StudyCases, quantity: str, case: str) -> float:
    """A quantity of ge_ni2005_wheel_speeds, of a case with `_` for each space of its name, in its unit."""
    return float(driven.results[case.replace("_", " ")].measured[quantity])


def slips_apart(driven: StudyCases, case: str) -> float:
    """Difference of the slips of both rear wheels there in the end [1]."""
    return studied(driven, "slip_left", case) - studied(driven, "slip_right", case)


def load(driven: ScenarioRuns, side: str, run: str) -> float:
    """Load of a rear wheel at the end of the figures [N]."""
    recording = run_named(driven.runs, run)
    return motion.value_at(recording, channel(recording, f"tire_forces.load.rear_{side}"), paper.INSTANT)


def slip_ahead(driven: ScenarioRuns, run: str) -> float:
    """Slip of the driven wheels straight ahead [1]."""
    return float(slip(run_named(driven.runs, run), "left")[0])


def _speed(of: Callable[..., np.ndarray], driven: ScenarioRuns, side: str, run: str) -> float:
    recording = run_named(driven.runs, run)
    return motion.value_at(recording, of(recording, side, driven.vehicle), paper.INSTANT)


def ground_speed(driven: ScenarioRuns, side: str, run: str) -> float:
    """Speed of the centre of a rear wheel along the wheel at the end of the figures [m/s]."""
    return _speed(quantities.ground_speed, driven, side, run)


def rim_speed(driven: ScenarioRuns, side: str, run: str) -> float:
    """Speed of the rim of a rear wheel at the end of the figures [m/s]."""
    return _speed(quantities.rim_speed, driven, side, run)


def _largest(run: Recording, values: np.ndarray, since: float) -> float:
    inside = values[(run.time >= since) & (run.time <= paper.INSTANT)]
    if not len(inside):
        raise NotMeasured(f"the run ends before {since:g} s")
    return float(np.abs(inside).max())


def largest_radius(driven: ScenarioRuns, run: str, since: float) -> float:
    """Largest radius of the path from an instant [s] to the end of the figures [m]."""
    return _largest(run_named(driven.runs, run), motion.radius_of_path(run_named(driven.runs, run)), since)


def largest_acceleration(driven: ScenarioRuns, run: str) -> float:
    """Largest centripetal acceleration up to the end of the figures [m/s^2]."""
    recording = run_named(driven.runs, run)
    return _largest(recording, motion.lateral_acceleration_on_path(recording), 0.0)


def time_to_own_yaw_rate(driven: ScenarioRuns, run: str) -> float:
    """Time to 90 % of the yaw rate that the run itself reaches [s]."""
    return quantities.own_response_time(run_named(driven.runs, run))


def time_to_that_of_equal_torques(driven: ScenarioRuns, run: str) -> float:
    """Time to 90 % of the yaw rate that equal torques reach [s]."""
    return response_time(run_named(driven.runs, run), quantity(driven, "yaw_rate", BASELINE))


def chatter(driven: ScenarioRuns, run: str, target: float) -> float:
    """Chatter of the torques of a run that comes to its target slip [1], in [N m/s]."""
    return quantities.chatter_at_its_target(run_named(driven.runs, run), target)


def rolling_efficiency(driven: ScenarioRuns, run: str) -> float:
    """What slip leaves of the work of the driven wheels in the end, the mean of 1 - l over both [1]."""
    recording = run_named(driven.runs, run)
    slips = (motion.value_at(recording, slip(recording, side), paper.INSTANT) for side in ("left", "right"))
    return 1.0 - sum(slips) / 2.0


def slip_over_target(driven: ScenarioRuns, side: str, run: str) -> float:
    """Slip of a rear wheel in the end over its target, l3* inside and l4* = l3* - K1 (w - delta u/L) outside [1]."""
    recording = run_named(driven.runs, run)
    yaw_rate = motion.value_at(recording, channel(recording, motion.YAW_RATE), paper.INSTANT)
    outside = paper.YAW_GAIN * (yaw_rate - paper.STEERING * paper.SPEED / paper.WHEELBASE)
    target = paper.TARGET - (outside if side == "right" else 0.0)
    return motion.value_at(recording, slip(recording, side), paper.INSTANT) / target


def mean_torque(driven: ScenarioRuns, run: str) -> float:
    """Mean torque request of a rear wheel over its chatter [N m]."""
    recording = run_named(driven.runs, run)
    late = recording.time >= recording.time[-1] - CHATTER_WINDOW
    return float(channel(recording, "torque_request.drive.rear_left")[late].mean())


def outer_target(driven: ScenarioRuns) -> float:
    """The law's target slip of the outer wheel when the wheels have just been turned [1]."""
    run = run_named(driven.runs, "offset")
    added = channel(run, "torque_request.drive.rear_right")[0] - paper.TORQUE
    return float(slip(run, "right")[0] + added * WIDE / OUTER_GAIN)


def change_of_target(driven: ScenarioRuns) -> float:
    """How far the printed target lies above that [1]."""
    return paper.TARGET - outer_target(driven)
