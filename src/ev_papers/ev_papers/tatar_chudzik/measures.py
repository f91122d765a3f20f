"""Measures of Tatar & Chudzik: forces in the axes of the car, their sums, and the claims.

Each public function measures one number of published.csv. A run is LAYOUT_CONTROL, such as
front_corrected, and `speed` [m/s] that at which it is looked at in the bend: at the same time the
corrected car is faster, and a faster car needs more force.
"""

from __future__ import annotations

import numpy as np

from ev_stack.measures import motion
from ev_stack.measures.handling import (
    energy_since_turning_in,
    total_force,
    turning_in,
    tyre_force,
    when_passing,
)
from ev_stack.measures.metric import channel, run_named
from ev_study.verdicts.need import ScenarioRuns

LAYOUTS = ("front", "rear", "all")
EQUAL = "equal"
CORRECTED = "corrected"
CONTROLS = (EQUAL, CORRECTED)
WHEELS = {"FL": "front_left", "FR": "front_right", "RL": "rear_left", "RR": "rear_right"}
TURNED = 1.0  # [s] after which the turn-in is over
STRAIGHT = 1.0  # [N] below which there is no lateral force


def curvature(driven: ScenarioRuns, run: str, speed: float) -> float:
    """Curvature of the path [1/m]."""
    recording = run_named(driven.runs, run)
    return when_passing(recording, speed, channel(recording, motion.YAW_RATE)) / speed


def force_y(driven: ScenarioRuns, wheel: str, run: str, speed: float) -> float:
    """F_y of a wheel in the axes of the car [N]."""
    recording = run_named(driven.runs, run)
    force = tyre_force(recording, WHEELS[wheel], driven.vehicle)
    return when_passing(recording, speed, force.y)


def sum_of_magnitudes(driven: ScenarioRuns, run: str, speed: float) -> float:
    """Sum of |F_y| of the four wheels [N]."""
    magnitudes = [np.abs(force) for force in _across(driven, run).values()]
    return when_passing(run_named(driven.runs, run), speed, np.sum(magnitudes, axis=0))


def signed_sum(driven: ScenarioRuns, run: str, speed: float) -> float:
    """Sum of F_y of the four wheels [N]."""
    forces = list(_across(driven, run).values())
    return when_passing(run_named(driven.runs, run), speed, np.sum(forces, axis=0))


def _across(driven: ScenarioRuns, run: str) -> dict[str, np.ndarray]:
    """F_y of each wheel in the axes of the car, (n,) [N]."""
    recording = run_named(driven.runs, run)
    return {name: tyre_force(recording, wheel, driven.vehicle).y for name, wheel in WHEELS.items()}


def drive_energy(driven: ScenarioRuns, run: str, speed: float) -> float:
    """Work of the drives since turning in [J]."""
    recording = run_named(driven.runs, run)
    return when_passing(recording, speed, energy_since_turning_in(recording))


def total_tyre_force(driven: ScenarioRuns, run: str, speed: float) -> float:
    """Sum of the magnitudes of the forces of all tyres [N]."""
    recording = run_named(driven.runs, run)
    return when_passing(recording, speed, total_force(recording))


def _bend(driven: ScenarioRuns, layout: str) -> tuple[int, np.ndarray]:
    """First sample with turned wheels under equal torques, and where the turn-in is over, (n,)."""
    run = run_named(driven.runs, f"{layout}_{EQUAL}")
    turn = turning_in(run)
    return turn, run.time >= run.time[turn] + TURNED


def inward(driven: ScenarioRuns, layout: str) -> bool:
    """True if F_y is zero until the turn, then to its inside, outer above inner in front."""
    forces = _across(driven, f"{layout}_{EQUAL}")
    turn, _ = _bend(driven, layout)
    is_straight = all(np.abs(force[:turn]).max() < STRAIGHT for force in forces.values())
    ends = {name: force[-1] for name, force in forces.items()}
    is_inward = all(end > 0.0 for end in ends.values())
    return is_straight and is_inward and bool(ends["FR"] > ends["FL"])


def front_drops(driven: ScenarioRuns, layout: str) -> bool:
    """True if in the bend F_x of the front wheels stays below that straight ahead."""
    run = run_named(driven.runs, f"{layout}_{EQUAL}")
    turn, late = _bend(driven, layout)
    forces = [tyre_force(run, WHEELS[wheel], driven.vehicle).x for wheel in ("FL", "FR")]
    return all(force[late].max() < force[turn] for force in forces)


def outer_above_inner(driven: ScenarioRuns, layout: str) -> bool:
    """True if in the bend the outer wheels are faster than the inner ones."""
    run = run_named(driven.runs, f"{layout}_{EQUAL}")
    _, late = _bend(driven, layout)

    def speed(wheel: str) -> np.ndarray:
        return channel(run, f"wheel_states.velocity.{wheel}")[late]

    in_front = speed("front_right") > speed("front_left")
    behind = speed("rear_right") > speed("rear_left")
    return bool(in_front.all() and behind.all())
