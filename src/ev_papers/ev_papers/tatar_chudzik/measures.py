"""What Tatar & Chudzik are judged by: forces in the axes of the car, their sums, and what is claimed of them.

Each public function measures one number of published.csv. A run is LAYOUT_CONTROL, such as front_corrected, and `speed`
[m/s] that at which it is looked at in the bend.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ev_sim.measures import motion
from ev_sim.measures.handling import energy_since_turning_in, total_force, turning_in, tyre_force, when_passing
from ev_sim.measures.metric import channel, run_named
from ev_study.verdicts.need import ScenarioRuns

LAYOUTS = ("front", "rear", "all")
CONTROLS = EQUAL, CORRECTED = ("equal", "corrected")
WHEELS = {"FL": "front_left", "FR": "front_right", "RL": "rear_left", "RR": "rear_right"}
TURNED = 1.0  # [s] after which the turn-in is over
STRAIGHT = 1.0  # [N] below which there is no lateral force
REAR_ARM = 2.0  # a_2 [m]


def _passing(driven: ScenarioRuns, run: str, speed: float, values: np.ndarray) -> float:
    return when_passing(run_named(driven.runs, run), speed, values)


def _across(driven: ScenarioRuns, run: str) -> dict[str, np.ndarray]:
    """F_y of each wheel in the axes of the car, (n,) [N]."""
    recording = run_named(driven.runs, run)
    return {name: tyre_force(recording, wheel, driven.vehicle).y for name, wheel in WHEELS.items()}


def curvature(driven: ScenarioRuns, run: str, speed: float) -> float:
    """Curvature of the path [1/m]."""
    return _passing(driven, run, speed, channel(run_named(driven.runs, run), motion.YAW_RATE)) / speed


def force_y(driven: ScenarioRuns, wheel: str, run: str, speed: float) -> float:
    """F_y of a wheel in the axes of the car [N]."""
    return _passing(driven, run, speed, tyre_force(run_named(driven.runs, run), WHEELS[wheel], driven.vehicle).y)


def sum_of_magnitudes(driven: ScenarioRuns, run: str, speed: float) -> float:
    """Sum of |F_y| of the four wheels [N]."""
    return _passing(driven, run, speed, np.sum([np.abs(force) for force in _across(driven, run).values()], axis=0))


def signed_sum(driven: ScenarioRuns, run: str, speed: float) -> float:
    """Sum of F_y of the four wheels [N]."""
    return _passing(driven, run, speed, np.sum(list(_across(driven, run).values()), axis=0))


def drive_energy(driven: ScenarioRuns, run: str, speed: float) -> float:
    """Work of the drives since turning in [J]."""
    return _passing(driven, run, speed, energy_since_turning_in(run_named(driven.runs, run)))


def total_tyre_force(driven: ScenarioRuns, run: str, speed: float) -> float:
    """Sum of the magnitudes of the forces of all tyres [N]."""
    return _passing(driven, run, speed, total_force(run_named(driven.runs, run)))


def _bend(driven: ScenarioRuns, layout: str) -> tuple[int, np.ndarray]:
    """Of the run with equal torques the first sample with turned wheels, and whether the turn-in is over, (n,) bool."""
    run = run_named(driven.runs, f"{layout}_{EQUAL}")
    turn = turning_in(run)
    return turn, run.time >= run.time[turn] + TURNED


def inward(driven: ScenarioRuns, layout: str) -> bool:
    """Whether F_y is zero until the turn, then to the inside of the bend, outer above inner in front."""
    force, (turn, late) = _across(driven, f"{layout}_{EQUAL}"), _bend(driven, layout)
    straight = all(np.abs(values[:turn]).max() < STRAIGHT for values in force.values())
    return straight and all(values[late][-1] > 0.0 for values in force.values()) and force["FR"][-1] > force["FL"][-1]


def front_drops(driven: ScenarioRuns, layout: str) -> bool:
    """Whether in the bend F_x of the front wheels stays below that straight ahead."""
    run, (turn, late) = run_named(driven.runs, f"{layout}_{EQUAL}"), _bend(driven, layout)
    forces = [tyre_force(run, WHEELS[wheel], driven.vehicle).x for wheel in ("FL", "FR")]
    return all(force[late].max() < force[turn] for force in forces)


def outer_above_inner(driven: ScenarioRuns, layout: str) -> bool:
    """Whether in the bend the outer wheels are faster than the inner ones."""
    run, (_, late) = run_named(driven.runs, f"{layout}_{EQUAL}"), _bend(driven, layout)
    speed: Mapping[str, np.ndarray] = {
        name: channel(run, f"wheel_states.velocity.{wheel}")[late] for name, wheel in WHEELS.items()
    }
    return all((speed[outer] > speed[inner]).all() for inner, outer in (("FL", "FR"), ("RL", "RR")))
