"""Claims of the dissertation on slip controls and differentials (sections 1.2, 1.4, 2.4).

Each public function measures one number of published.csv, on launches: of the study asr_shootout,
where `road` is a situation with `_` for each space of its name, or of the scenario launch_split_mu.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ev_papers.dissertation.measures.slip_curve import (
    LITTLE_SLIP,
    MUCH_SLIP,
    first_passed_peak,
    slip_and_road_torque,
)
from ev_sim.surfaces import SURFACES
from ev_stack.measures.metric import NotMeasured, channel, run_named, stretches
from ev_study.verdicts.need import ScenarioRuns, StudyCases

# Controls of section 1.4: by forecast of slip, by slip, by torque; the last is the dissertation's.
_GROUPS = {
    "forecast": (
        "acceleration_ratio",
        "speed_by_acceleration_ratio",
        "expected_signal",
        "adhesion_limit",
    ),
    "slip": (
        "speed_by_slip",
        "fuzzy",
        "pi_slip",
        "feedback_linearisation",
        "modified_lambda",
    ),
    "torque": (
        "held_torque",
        "slip_window",
        "maximum_transmissible_torque",
        "least_squares",
    ),
}
_UP_TO_SPEED = 2.0  # [s], when a launch is on its way
_LAST = 1.0  # [s]
_LEFT = "front_left"
ROLLING = 1.0  # [m/s], above which a car is not at rest


def launched(driven: StudyCases, quantity: str, road: str, control: str) -> float:
    """A quantity of a launch as asr_shootout measures it, in its unit."""
    value = _measured(driven, road, control)[quantity]
    if value is None:
        raise NotMeasured(f"{control} has no {quantity} on {road}")
    return float(value)


def _measured(driven: StudyCases, road: str, control: str) -> Mapping[str, Any]:
    return driven.results[f"{road.replace('_', ' ')}: {control}"].measured


def farthest(driven: StudyCases, road: str, group: str) -> float:
    """Longest distance that a control of a group comes [m]."""
    return max(launched(driven, "distance", road, control) for control in _GROUPS[group])


def quickest(driven: StudyCases, road: str, group: str) -> float:
    """Shortest time in which a control of a group gives the torque back on more friction [s]."""
    return min(launched(driven, "recovery", road, control) for control in _GROUPS[group])


def _last_slips(driven: StudyCases, road: str, control: str) -> np.ndarray:
    """Slips of the front left wheel in the last second of a launch, (n,) [1]."""
    measured = _measured(driven, road, control)
    time = measured["trace_time"]
    return measured["trace_slip"][time >= time[-1] - _LAST]


def last_slip(driven: StudyCases, road: str, control: str) -> float:
    """Mean slip of the front left wheel in the last second of a launch [1]."""
    return float(_last_slips(driven, road, control).mean())


def slip_swing(driven: StudyCases, road: str, control: str) -> float:
    """Swing of that slip, from its smallest to its largest value [1]."""
    return float(np.ptp(_last_slips(driven, road, control)))


def _of_front(driven: ScenarioRuns, name: str) -> np.ndarray:
    """A quantity of the front wheels of a launch on its way, (2, n), left first."""
    (run,) = driven.runs.values()
    wheels = np.array([channel(run, f"{name}.{wheel}") for wheel in (_LEFT, "front_right")])
    return np.ascontiguousarray(wheels[:, run.time >= _UP_TO_SPEED])


def grip_used(driven: ScenarioRuns) -> float:
    """Mean drive force of both wheels over what the road gives them [1]."""
    load = _of_front(driven, "tire_forces.load")
    grip = load * _of_front(driven, "tire_forces.friction_coefficient")
    return float(_of_front(driven, "tire_forces.longitudinal_force").sum() / grip.sum())


def front_slip(driven: ScenarioRuns) -> float:
    """Mean slip of both wheels [1]."""
    return float(_of_front(driven, "tire_forces.slip_ratio").mean())


def share_beyond_grip(driven: ScenarioRuns) -> float:
    """Share of the left wheel in the torque less its share in the friction [1]."""
    torque = _of_front(driven, "torque_command.drive").sum(axis=1)
    friction = _of_front(driven, "tire_forces.friction_coefficient").sum(axis=1)
    return float(torque[0] / torque.sum() - friction[0] / friction.sum())


def motor_torque(driven: ScenarioRuns, sample: str) -> float:
    """Torque of the left motor when the slip begins to rise, or when it has passed its peak [N m].

    `sample` is the first or the last one of the fitted window.
    """
    run = run_named(driven.runs, "urban_mixed")
    window = first_passed_peak(run, driven.vehicle, _LEFT).window
    torque = channel(run, f"motor_states.effort.{_LEFT}")[window]
    return float(torque[0] if sample == "first" else torque[-1])


def torque_over_slip(driven: ScenarioRuns, start: str, number: float) -> float:
    """Torque of the left motor where the slip is largest over that where the slip begins [1].

    `number` counts the slips of a car that is rolling at the start of them, or from rest.
    """
    run = run_named(driven.runs, "urban_mixed")
    slip = channel(run, f"tire_forces.slip_ratio.{_LEFT}")
    torque = channel(run, f"motor_states.effort.{_LEFT}")
    speed = channel(run, "twist.longitudinal")
    found = []
    for slips in stretches(slip > MUCH_SLIP):
        # It begins where the wheel has last gripped.
        gripped = int(np.flatnonzero(slip[: slips.start] < LITTLE_SLIP)[-1])
        largest = slips.start + int(np.argmax(slip[slips]))
        if (speed[gripped] > ROLLING) == (start == "rolling"):
            found.append(float(torque[largest] / torque[gripped]))
    if len(found) < number:
        raise NotMeasured(f"the left wheel slips {len(found)} times {start.replace('_', ' ')}")
    return found[int(number) - 1]


def fit_error(driven: ScenarioRuns, power: float) -> float:
    """Error F of the template y = A x + B x^power where the left wheel passes its peak [1]."""
    run = run_named(driven.runs, "urban_mixed")
    window = first_passed_peak(run, driven.vehicle, _LEFT).window
    slip, torque = slip_and_road_torque(run, driven.vehicle, _LEFT)
    x, y = slip[window], torque[window]
    _, residuals, *_ = np.linalg.lstsq(np.column_stack((x, x**power)), y)
    return float(residuals.sum())


def slope_coefficient(surface: str) -> float:
    """C_3 by its meaning in the text, over largest friction less that of a spinning wheel [1]."""
    of = SURFACES[surface]
    spinning = of.c1 * (1.0 - np.exp(-of.c2)) - of.c3
    return of.c3 / (of.peak_friction - spinning)


def height_coefficient(surface: str) -> float:
    """C_1 over the largest friction, its meaning in the text [1]."""
    return SURFACES[surface].c1 / SURFACES[surface].peak_friction
