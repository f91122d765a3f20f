"""Claims of the dissertation on slip controls and differentials (sections 1.2, 1.4, 2.4) as they are judged.

Each public function measures one number of published.csv, on launches: of the study asr_shootout, where `road` is a
situation with `_` for each space of its name, or of the scenario launch_split_mu with something changed.
"""

from __future__ import annotations

import numpy as np

from ev_papers.dissertation.measures.slip_curve import first_passed_peak, slip_and_road_torque
from ev_sim.surfaces import SURFACES
from ev_stack.measures.metric import NotMeasured, channel, run_named
from ev_stack.recording.recording import Recording
from ev_study.verdicts.need import ScenarioRuns, StudyCases

_GROUPS = {  # of section 1.4: by forecast of slip, by slip, by torque; the last one is the dissertation's own
    "forecast": (
        "acceleration_ratio",
        "speed_by_acceleration_ratio",
        "expected_signal",
        "adhesion_limit",
    ),
    "slip": ("speed_by_slip", "fuzzy", "pi_slip", "feedback_linearisation", "modified_lambda"),
    "torque": ("held_torque", "slip_window", "maximum_transmissible_torque", "least_squares"),
}
_UP_TO_SPEED = 2.0  # [s], when a launch is on its way
_SETTLED = 4.0  # [s]
_LAST = 1.0  # [s]
_FRONT = ("front_left", "front_right")


def launched(driven: StudyCases, quantity: str, road: str, control: str) -> float:
    """A quantity of a launch as asr_shootout measures it, in its unit."""
    value = driven.results[f"{road.replace('_', ' ')}: {control}"].measured[quantity]
    if value is None:
        raise NotMeasured(f"{control} has no {quantity} on {road}")
    return float(value)


def farthest(driven: StudyCases, road: str, group: str) -> float:
    """The longest distance that a control of a group comes [m]."""
    return max(launched(driven, "distance", road, control) for control in _GROUPS[group])


def quickest(driven: StudyCases, road: str, group: str) -> float:
    """The shortest time in which a control of a group gives the torque back after a jump to more friction [s]."""
    return min(launched(driven, "recovery", road, control) for control in _GROUPS[group])


def _last_slips(driven: StudyCases, road: str, control: str) -> np.ndarray:
    measured = driven.results[f"{road.replace('_', ' ')}: {control}"].measured
    time = measured["trace_time"]
    return measured["trace_slip"][time >= time[-1] - _LAST]


def last_slip(driven: StudyCases, road: str, control: str) -> float:
    """Mean slip of the front left wheel in the last second of a launch [1]."""
    return float(_last_slips(driven, road, control).mean())


def slip_swing(driven: StudyCases, road: str, control: str) -> float:
    """By how much it swings there, from its smallest to its largest value [1]."""
    return float(np.ptp(_last_slips(driven, road, control)))


def _launch(driven: ScenarioRuns) -> Recording:
    (run,) = driven.runs.values()
    return run


def _of_front(run: Recording, name: str, since: float = _UP_TO_SPEED) -> np.ndarray:
    """A quantity of the front wheels from an instant on, (2, n), left first."""
    return np.array([channel(run, f"{name}.{wheel}")[run.time >= since] for wheel in _FRONT])


def grip_used(driven: ScenarioRuns) -> float:
    """Mean drive force of both wheels over what the road gives them [1]."""
    run = _launch(driven)
    grip = _of_front(run, "tire_forces.load") * _of_front(run, "tire_forces.friction_coefficient")
    return float(_of_front(run, "tire_forces.longitudinal_force").sum() / grip.sum())


def front_slip(driven: ScenarioRuns) -> float:
    """Mean slip of both wheels [1]."""
    return float(_of_front(_launch(driven), "tire_forces.slip_ratio").mean())


def share_beyond_grip(driven: ScenarioRuns) -> float:
    """Share of the torque that the left wheel gets less its share of the friction [1]."""
    run = _launch(driven)
    torque, friction = (
        _of_front(run, name).sum(axis=1)
        for name in ("torque_command.drive", "tire_forces.friction_coefficient")
    )
    return float(torque[0] / torque.sum() - friction[0] / friction.sum())


def motor_torque(driven: ScenarioRuns, sample: str) -> float:
    """Torque of the left motor when the slip begins to rise, or when it has passed its peak (first, last) [N m]."""
    run = run_named(driven.runs, "urban_mixed")
    window = first_passed_peak(run, driven.vehicle, "front_left").window
    return float(
        channel(run, "motor_states.effort.front_left")[window][{"first": 0, "last": -1}[sample]]
    )


def fit_error(driven: ScenarioRuns, power: float) -> float:
    """Error F of the template y = A x + B x^power where the left wheel passes its peak [1]."""
    run = run_named(driven.runs, "urban_mixed")
    window = first_passed_peak(run, driven.vehicle, "front_left").window
    x, y = (values[window] for values in slip_and_road_torque(run, driven.vehicle, "front_left"))
    return float(np.linalg.lstsq(np.column_stack((x, x**power)), y)[1].sum())


def slope_coefficient(surface: str) -> float:
    """C_3 over what the text says it is, the largest friction less that of a wheel that spins [1]."""
    of = SURFACES[surface]
    return of.c3 / (of.peak_friction - (of.c1 * (1.0 - np.exp(-of.c2)) - of.c3))


def height_coefficient(surface: str) -> float:
    """C_1 over what the text says it is, the largest friction [1]."""
    return SURFACES[surface].c1 / SURFACES[surface].peak_friction
